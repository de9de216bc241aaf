"""What a vibration settles to, decided once for pads and for structures."""
