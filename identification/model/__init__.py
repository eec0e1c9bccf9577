"""From a plant's equations to what an estimator needs of them: a smaller model, what its sensors show, its motion with exact slopes."""
