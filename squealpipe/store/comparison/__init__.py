"""One run held against another: dataset by dataset, number by number, verdict by verdict."""
