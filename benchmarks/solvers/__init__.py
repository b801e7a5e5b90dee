"""Who computes the motions: dalembert and its peers, each from the same neutral description."""
