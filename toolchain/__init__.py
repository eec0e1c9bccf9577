"""One compiler for host and target: the zig wheel, with a content-addressed cache."""
