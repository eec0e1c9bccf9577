"""The kinds of rig: a plan of effects in, a drawn rig with the place where it flies out."""
