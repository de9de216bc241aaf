"""Prediction of the results that an edit makes stale, and of the work to renew them."""
