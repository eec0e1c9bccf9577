"""From a plant to a linear model whose matrices are functions of free parameters, its response and its run."""
