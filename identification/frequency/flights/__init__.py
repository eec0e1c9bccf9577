"""From a plant and a band to sweep inputs and the flights made with them."""
