"""From records, one after another, to estimates: each fits its own parameters and hands on what is known."""
