"""Solutions of 3_a_diffusion_policy, each under the name that its exercise uses."""


# 3.1: the squares of the two weights add up to 1
def noisy(actions, noise, abar):
    return abar**0.5 * actions + (1 - abar) ** 0.5 * noise


# 3.2: equation 5: take the noise out, and put back what belongs to the next level
def ddim_step(x, eps, abar, abar_next):
    clean = (x - (1 - abar) ** 0.5 * eps) / abar**0.5
    return abar_next**0.5 * clean + (1 - abar_next) ** 0.5 * eps


# 3.3: 67 decisions for 200 steps, three a decision, of ten DDIM steps each
passes = 67 * 10
