"""From frequency responses and a model to the parameters that match them, with intervals."""
