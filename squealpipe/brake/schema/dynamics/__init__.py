"""What is computed in time: single runs and their summaries, maps of long runs, assumptions."""
