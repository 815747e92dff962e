"""Writes what recordings.py writes, and small recordings that unpack to much.

Arguments: those of recordings.py.
"""
import numpy as np
from mcap.writer import CompressionType

from recordings import mcap, rosbag1


def zeros(height):
    """Images of so many rows of 16384 pixels without depth, in a chunk each."""
    def messages(maker):
        nothing = np.zeros((height, 16384), np.uint16)
        for k in range(3):
            yield "/depth/image_raw", "sensor_msgs/msg/Image", k, maker.image(k, "optical", nothing, "16UC1")
            yield "/depth/camera_info", "sensor_msgs/msg/CameraInfo", k, maker.info(k, "optical")

    return messages


# Of 112 and of 88 MB a chunk: more and less than is unpacked.
bomb, large = zeros(3500), zeros(2750)
mcap("bomb-zstd.mcap", bomb, compression=CompressionType.ZSTD)
mcap("bomb-lz4.mcap", bomb, compression=CompressionType.LZ4)
mcap("large-zstd.mcap", large, compression=CompressionType.ZSTD)
rosbag1("bomb-bz2.bag", bomb, "BZ2")
rosbag1("bomb-lz4.bag", bomb, "LZ4")
rosbag1("large-lz4.bag", large, "LZ4")
