"""From a plant's equations to what an estimator needs of them: a smaller model, and what its sensors show."""
