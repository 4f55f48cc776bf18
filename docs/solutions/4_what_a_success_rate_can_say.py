"""Solutions of 4_what_a_success_rate_can_say, each under the name that its exercise uses."""

import numpy as np

# 4.1: by trying; 1.96 * sqrt(0.25 / n) = 0.05 gives about as many, 384
trials_needed = 381


# 4.2: one difference a configuration
def paired(first, second):
    apart = first.mean(axis=0) - second.mean(axis=0)
    return apart.mean(), apart.std(ddof=1) / np.sqrt(len(apart))


# 4.3: by trying; power is 0.795 with 195 and 0.806 with 200
trials_for_80 = 200
