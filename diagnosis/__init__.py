"""From logs and a plant file to where the model lacks something, which effect that is, and how far the gap shrinks."""
