"""From recorded experiments and run logs to a plant file whose standard deviations and correlations are earned."""
