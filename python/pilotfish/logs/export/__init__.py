"""A recording in other formats: MCAP (Foxglove), CSV, Parquet, MP4. Row by row: hours of it need no more memory than
minutes, but for MP4, which looks up what was seen in each image in the numbers of the whole run."""
