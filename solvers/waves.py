"""Two acoustic half-lines and their exact solution by characteristics: Section 4 of Banks & Sjögreen.

On each side u_t = sigma_x/rho, sigma_t = kappa u_x, kappa = rho c**2. With

    a = (u/c + sigma/kappa)/2,  b = (-u/c + sigma/kappa)/2,  u = c (a - b),  sigma = kappa (a + b)

the equations are a_t = c a_x and b_t = -c b_x: a runs to the left, b to the right. A pulse b = f(x) on the left meets
the interface, where u and sigma are continuous and nothing comes from the right (a_R = 0). With the
impedance Z = rho c,

    a_L(0, t) = (Z_R - Z_L)/(Z_R + Z_L) f(-c_L t),    b_R(0, t) = (c_L/c_R) 2 Z_L/(Z_R + Z_L) f(-c_L t),

and along the characteristics a_L(x, t) = a_L(0, t + x/c_L), b_R(x, t) = b_R(0, t - x/c_R).

The printed solution departs from this in three places. For x < -c t it has f(-ct), a pulse that does not depend on x,
where the characteristic through (x, t) carries f(x - ct). For -ct <= x < 0 its velocity has +2 f where u = c (a - b)
has -2 f, so that its u jumps at the interface by 2 c f(-ct). And f is centred at +1/2, on the far side: nothing would
meet the interface then, while the text's "latter stages of interacting" at t = 0.375 is a pulse from -1/2, which
arrives at t = 0.5/sqrt(3) = 0.289. (4.2), for equal speeds, is right as printed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Medium:
    """Density rho and wave speed c of one side; modulus kappa = rho c**2, impedance Z = rho c."""

    density: float
    speed: float

    @property
    def modulus(self) -> float:
        return self.density * self.speed**2

    @property
    def impedance(self) -> float:
        return self.density * self.speed


@dataclass(frozen=True, slots=True)
class Pulse:
    """f(x) = exp(-sharpness (x - centre)**2); by default the text's, from where it meets the interface."""

    centre: float = -0.5
    sharpness: float = 100.0

    def __call__(self, x: Array) -> Array:
        return np.asarray(np.exp(-self.sharpness * (x - self.centre) ** 2))


@dataclass(frozen=True, slots=True)
class Interface:
    """Two media that meet at x = 0, and a pulse b = f(x) on the left that runs to the right."""

    left: Medium
    right: Medium
    pulse: Pulse = Pulse()

    @classmethod
    def of_ratio(cls, alpha: float, speed: float = sqrt(3.0)) -> Interface:
        """Equal speeds, rho_L = 1 and rho_R = alpha: Section 4's media with alpha = kappa_R/kappa_L."""
        return cls(Medium(1.0, speed), Medium(alpha, speed))

    @property
    def reflection(self) -> float:
        """a_L/f at the interface."""
        z_left, z_right = self.left.impedance, self.right.impedance
        return (z_right - z_left) / (z_right + z_left)

    @property
    def transmission(self) -> float:
        """b_R/f at the interface."""
        z_left, z_right = self.left.impedance, self.right.impedance
        return self.left.speed / self.right.speed * 2.0 * z_left / (z_right + z_left)

    def left_characteristics(self, x: Array, t: float) -> tuple[Array, Array]:
        """(a, b) at x < 0."""
        c = self.left.speed
        return self.reflection * self.pulse(-x - c * t), self.pulse(x - c * t)

    def right_characteristics(self, x: Array, t: float) -> tuple[Array, Array]:
        """(a, b) at x > 0: nothing before the wave front x = c t, ahead of which the medium is at rest."""
        c = self.right.speed
        wave = self.transmission * self.pulse(self.left.speed / c * (x - c * t))
        return np.zeros_like(x), np.where(x < c * t, wave, 0.0)

    def exact(self, x: Array, t: float) -> tuple[Array, Array]:
        """(u, sigma) at the points x and time t."""
        x = np.asarray(x, dtype=float)
        left = x < 0
        (a_left, b_left), (a_right, b_right) = self.left_characteristics(x, t), self.right_characteristics(x, t)
        a, b = np.where(left, a_left, a_right), np.where(left, b_left, b_right)
        c = np.where(left, self.left.speed, self.right.speed)
        return c * (a - b), np.where(left, self.left.modulus, self.right.modulus) * (a + b)
