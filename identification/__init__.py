"""From recorded experiments to a plant file whose standard deviations and correlations are earned."""
