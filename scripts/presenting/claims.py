# SPDX-License-Identifier: Apache-2.0
"""All results of docs/results, in their order."""
from presenting.builds import fast_math, hosts, processors, riddle
from presenting.inputs import stored
from presenting.methods import epsilon, league, price, which

RESULTS = (riddle, hosts, price, which, fast_math, processors, stored, league, epsilon)


def results(records):
    """Returns: the results, each with the records that it uses. Throws: Unsupported."""
    found = []
    for write in RESULTS:
        records.used = {}
        found.append(write(records))
        found[-1].records = records.used
    return found
