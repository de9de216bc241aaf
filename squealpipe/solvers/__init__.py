"""Models prepared for the methods that solve them: arrays in, arrays out."""
