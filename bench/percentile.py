# SPDX-License-Identifier: Apache-2.0
"""Percentiles by nearest rank: of 100 values the 99th is the second largest."""
import math


def percentile(values, share):
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]
