"""ADC, the second baseline: object and target jump as the gripper comes near.

Wherever methods are compared it has all its jumps (`usual`); table_adc compares the readings.
"""

from move.sim.methods.method import Method
from move.sim.motion.adc import MENDED, Jumps

ADC = Method(
    "adc", "ADC", "#E69F00", "s", reads=("jumping",), usual={"jumping": MENDED},
    wrap=lambda scene, collection: Jumps(scene, collection.factors, collection.jumping),
)
