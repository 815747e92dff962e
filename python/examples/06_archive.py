"""Many frames, with Ray: a row of Parquet for each. `pip install "objecthood[ray]"`; RAY_ADDRESS names a cluster."""

import sys

import pyarrow.dataset

from objecthood.ray import segment

inputs, out = sys.argv[1:]  # paths, or s3:// and gs://
summary = segment(inputs, out)
print(f"{summary['done']} of {summary['frames']} frames, {summary['objects']} objects")
table = pyarrow.dataset.dataset(f"{out}/frames", partitioning="hive").to_table(columns=["frame", "objects"])
for row in table.slice(0, 3).to_pylist():
    print(row["frame"], [round(thing["objectness"], 2) for thing in row["objects"]])
