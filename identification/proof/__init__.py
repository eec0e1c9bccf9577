"""From an identified plant to what shows that it is right: other rigs, flights of its controller, another rotor, other tools."""
