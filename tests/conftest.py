"""One thread for the linear algebra of every test, as for `twinlaw` itself: this import comes before NumPy's."""

import twinlaw as twinlaw
