"""From a plant file to a flight: designing, building, verifying, proving and flying, each leaving its files and handing on records."""
