"""A bag of ROS in; each number of its topics as a signal out."""
