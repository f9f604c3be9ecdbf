

class Device:
    """One axis: `step` it with an input, `reading` is what its position sensor shows."""

    def __init__(self, position=0.0, velocity=0.0, **numbers):
        self.__dict__.update(NUMBERS, **numbers)
        self.position, self.velocity, self.time = position, velocity, 0.0
        self._under_way = deque([(-math.inf, 0.0)])
        self._torque = self._lagged = 0.0

    def taken(self, u):
        """What limit and saturation take of an input."""
        pushed = math.copysign(1.0, self.ratio * u)
        left = 1.0
        if math.isfinite(self.no_load_velocity):
            left = max(0.0, 1.0 - self.velocity * pushed / self.no_load_velocity)
        most, size = left * self.saturation_limit, min(abs(u), self.limit)
        if math.isfinite(most):
            bent, reach = size - (1.0 - self.saturation_knee) * most, 2.0 * self.saturation_knee * most
            if bent >= reach and bent > 0.0:
                size = most
            elif bent > 0.0:
                size -= bent * bent / (2.0 * reach)
        return math.copysign(size, u)

    def beyond_deadband(self, u):
        """What the dead band leaves of an input."""
        off = u - self.deadband_skew * self.deadband
        if self.deadband == 0.0:
            return u
        if abs(off) <= self.deadband:
            return 0.0
        return u - (1.0 - self.deadband_jump) * (math.copysign(1.0, off) + self.deadband_skew) * self.deadband

    def drive(self, u, dt):
        """The joint torque of an input that is held for `dt`."""
        first, last = self.beyond_deadband, self.taken
        if not self.deadband_first:
            first, last = last, first
        self._under_way.append((self.time + self.delay_s, self.ratio * last(first(u))))
        while len(self._under_way) > 1 and self._under_way[1][0] <= self.time + 1e-12:
            self._under_way.popleft()
        told = self._under_way[0][1]
        lag = lambda state, to, lag_s: to + (state - to) * math.exp(-dt / lag_s) if lag_s > 0.0 else to
        self._lagged = lag(self._lagged, told, self.lag_s)
        self._torque = lag(self._torque, self._lagged, self.further_lag_s)
        return self._torque

    def passive(self):
        """Gravity and spring."""
        x, away = self.position, self.position - self.stiffness_zero
        weight = self.gravity * math.sin(self.angle_rad * (x - self.gravity_zero))
        return -weight - self.stiffness * away * (1.0 + self.hardening * away * away)

    def level(self, direction, speed, transmitted):
        """The level of dry friction against motion in a direction."""
        x = self.position
        level = self.level_forward if direction > 0.0 else self.level_backward
        at = 1.0 + self.level_slope * x + self.level_curve * x * x
        at += self.level_sine * math.sin(self.level_wave_number * x)
        at += self.level_cosine * (math.cos(self.level_wave_number * x) - 1.0)
        at += self.spot_height * math.exp(-abs((x - self.spot_position) / self.spot_width) ** self.spot_exponent)
        fall = 1.0
        if self.static_ratio != 1.0:
            p = abs(speed / self.stribeck_velocity) ** self.stribeck_exponent
            t = self.stribeck_tail
            fall += (self.static_ratio - 1.0) * ((1.0 + t * p) ** (-1.0 / t) if t > 0.0 else math.exp(-p))
        share = self.load_share
        if direction * transmitted < 0.0:
            share = max(0.0, share + self.load_backdriven_extra)
        return level * max(0.0, at) * fall + share * abs(transmitted)

    def step(self, u, dt):
        """Goes on by `dt` s under the input `u`; returns the reading."""
        torque, x, v = self.drive(u, dt), self.position, self.velocity
        passive = self.passive()
        smooth = torque + passive + self.offset - self.viscous * v - self.drag * v * abs(v)
        angle = self.cogging_wave_number * x + self.cogging_phase
        smooth += self.cogging * math.sin(angle) + self.cogging_second_sine * math.sin(2.0 * angle)
        smooth += self.cogging_second_cosine * math.cos(2.0 * angle)
        if x > self.upper_stop:
            smooth -= max(0.0, self.upper_stiffness * (x - self.upper_stop) + self.upper_damping * v)
        if x < self.lower_stop:
            smooth += max(0.0, self.lower_stiffness * (self.lower_stop - x) - self.lower_damping * v)
        free = v + smooth / self.inertia * dt
        direction = math.copysign(1.0, free)
        friction = self.level(direction, v, torque + self.load_passive * passive)
        slowed = friction / self.inertia * dt
        # Dry friction stops a motion, it never turns it round.
        self.velocity = 0.0 if abs(free) <= slowed else free - direction * slowed
        self.position = x + self.velocity * dt
        self.time += dt
        return self.reading()

    def reading(self):
        """What the sensor shows, noise and quantising apart."""
        x = self.position
        smooth = self.sensor_offset + x * (self.sensor_gain + x * (self.sensor_quadratic + x * self.sensor_cubic))
        turn = self.sensor_wave_number * x
        return smooth + self.sensor_sine * math.sin(turn) + self.sensor_cosine * (math.cos(turn) - 1.0)
