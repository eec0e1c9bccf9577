"""A simulated helicopter in place of flight tests that are not public: equations, integration and noise that no estimator knows."""
