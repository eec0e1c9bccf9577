"""Plant and log files go in, the files of a diagnosis come out: of logs explained together, of many by themselves, of baselines."""
