"""From estimates to what is handed on: a plant file with earned standard deviations, and notes on what the data cannot tell."""
