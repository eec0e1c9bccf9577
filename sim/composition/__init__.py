"""A nominal model and the effects that a plant file names in; the model with their equations and the stages of its signals out."""
