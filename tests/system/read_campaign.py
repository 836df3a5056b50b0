"""Means of the columns of a campaign's runs, read by h5py: read_campaign.py campaign.h5"""
import json
import os
import sys

try:
    import h5py
except ImportError:
    sys.exit(77)

os.chdir(os.path.dirname(os.path.abspath(sys.argv[1])))  # a virtual dataset names its files from here
with h5py.File(os.path.basename(sys.argv[1])) as file:
    runs = file["runs"]
    names = [name.decode() for name in runs.attrs["columns"]]
    rows = runs[...]
json.dump({"runs": len(rows), "mean": dict(zip(names, rows.mean(axis=0).tolist()))}, sys.stdout)
