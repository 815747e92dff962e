"""Graph segmentation by OpenCV and scikit-image, one thread: times of the images that come in on stdin.

usage: graph_segmentation.py SIGMA K MIN_SIZE
An image is a line `WIDTH HEIGHT` and its bytes, RGB. The answer is a line `series TAB value` for each figure, and an empty line.
"""
import sys
import time

import cv2
import numpy as np
from skimage.segmentation import felzenszwalb

sigma, k, min_size = float(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
cv2.setNumThreads(1)
opencv = cv2.ximgproc.segmentation.createGraphSegmentation(sigma, k, min_size)


def measure(name, segment):
    wall, cpu = time.perf_counter(), time.process_time()
    labels = segment()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    print(f"{name}/wall_ms\t{1e3 * wall}\n{name}/cpu_ms\t{1e3 * cpu}\n{name}/segments\t{len(np.unique(labels))}")


while header := sys.stdin.buffer.readline():
    width, height = map(int, header.split())
    rgb = np.frombuffer(sys.stdin.buffer.read(3 * width * height), np.uint8).reshape(height, width, 3)
    bgr = np.ascontiguousarray(rgb[..., ::-1])
    measure("opencv graph", lambda: opencv.processImage(bgr))
    # Within, the image is scaled to 0..1 and k by 1/255: the same k means the same.
    measure("skimage graph", lambda: felzenszwalb(rgb, scale=k, sigma=sigma, min_size=min_size))
    print(flush=True)
