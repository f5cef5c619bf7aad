"""Signals that are drawn: what drivers, muscles and errors do."""

import numpy


def smooth(random, time, correlation_s):
    """A Gaussian process of unit variance at even times, with correlation exp(-(lag/correlation)^2/2)."""
    step = time[1] - time[0]
    half = int(numpy.ceil(3.0 * correlation_s / step))
    kernel = numpy.exp(-((numpy.arange(-half, half + 1) * step / correlation_s) ** 2))
    white = random.standard_normal(len(time) + 2 * half)
    return numpy.convolve(white, kernel, "valid") / numpy.linalg.norm(kernel)
