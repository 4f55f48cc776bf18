"""Solutions of 3_a_diffusion_policy, each under the name that its exercise uses."""


# 3.1: the squares of the two weights add up to 1
def noisy(actions, noise, alpha_bar):
    return alpha_bar**0.5 * actions + (1 - alpha_bar) ** 0.5 * noise


# 3.2: equation 5: take the noise out, and put back what belongs to the next level
def ddim_step(x, eps, alpha_bar, alpha_bar_next):
    clean = (x - (1 - alpha_bar) ** 0.5 * eps) / alpha_bar**0.5
    return alpha_bar_next**0.5 * clean + (1 - alpha_bar_next) ** 0.5 * eps


# 3.3: 67 decisions for 200 steps, three a decision, of ten DDIM steps each
passes = 67 * 10
