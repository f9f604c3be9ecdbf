LONGEST = 4096;  % steps that fit into the delay
persistent x v lagged acting line
if isempty(x)
    x = position0; v = velocity0; lagged = 0; acting = 0; line = zeros(1, LONGEST);
end
if p.deadband_first
    settled = p.ratio * taken(p, beyond(p, u), v);
else
    settled = p.ratio * beyond(p, taken(p, u, v));
end
line = [settled, line(1:end-1)];
told = line(min(LONGEST, 1 + round(p.delay_s / dt)));
lagged = follow(lagged, told, p.lag_s, dt);
acting = follow(acting, lagged, p.further_lag_s, dt);
away = x - p.stiffness_zero;
passive = -p.gravity * sin(p.angle_rad * (x - p.gravity_zero)) - p.stiffness * away * (1 + p.hardening * away^2);
angle = p.cogging_wave_number * x + p.cogging_phase;
smooth = acting + passive + p.offset - p.viscous * v - p.drag * v * abs(v) ...
    + p.cogging * sin(angle) + p.cogging_second_sine * sin(2 * angle) + p.cogging_second_cosine * cos(2 * angle);
if x > p.upper_stop
    smooth = smooth - max(0, p.upper_stiffness * (x - p.upper_stop) + p.upper_damping * v);
end
if x < p.lower_stop
    smooth = smooth + max(0, p.lower_stiffness * (p.lower_stop - x) - p.lower_damping * v);
end
free = v + smooth / p.inertia * dt;
slowed = level(p, free, x, v, acting + p.load_passive * passive) / p.inertia * dt;
if abs(free) <= slowed  % dry friction stops a motion, it never turns it round
    v = 0;
else
    v = free - sign(free) * slowed;
end
x = x + v * dt;
turn = p.sensor_wave_number * x;
reading = p.sensor_offset + x * (p.sensor_gain + x * (p.sensor_quadratic + x * p.sensor_cubic)) ...
    + p.sensor_sine * sin(turn) + p.sensor_cosine * (cos(turn) - 1);
end

function y = taken(p, u, v)
left = 1;
if isfinite(p.no_load_velocity)
    left = max(0, 1 - v * sign(p.ratio * u) / p.no_load_velocity);
end
most = left * p.saturation_limit;
y = min(abs(u), p.limit);
if isfinite(most)
    bent = y - (1 - p.saturation_knee) * most;
    reach = 2 * p.saturation_knee * most;
    if bent > 0 && bent >= reach
        y = most;
    elseif bent > 0
        y = y - bent^2 / (2 * reach);
    end
end
y = y * sign(u);
end

function y = beyond(p, u)
y = u;
if p.deadband > 0
    off = u - p.deadband_skew * p.deadband;
    if abs(off) <= p.deadband
        y = 0;
    else
        y = u - (1 - p.deadband_jump) * (sign(off) + p.deadband_skew) * p.deadband;
    end
end
end

function y = follow(state, to, lag_s, dt)
y = to;
if lag_s > 0
    y = to + (state - to) * exp(-dt / lag_s);
end
end

function y = level(p, direction, x, v, transmitted)
if direction > 0
    y = p.level_forward;
else
    y = p.level_backward;
end
at = 1 + p.level_slope * x + p.level_curve * x^2 + p.level_sine * sin(p.level_wave_number * x) ...
    + p.level_cosine * (cos(p.level_wave_number * x) - 1) ...
    + p.spot_height * exp(-abs((x - p.spot_position) / p.spot_width)^p.spot_exponent);
fall = 1;
if p.static_ratio ~= 1
    q = abs(v / p.stribeck_velocity)^p.stribeck_exponent;
    if p.stribeck_tail > 0
        fall = fall + (p.static_ratio - 1) * (1 + p.stribeck_tail * q)^(-1 / p.stribeck_tail);
    else
        fall = fall + (p.static_ratio - 1) * exp(-q);
    end
end
share = p.load_share;
if direction * transmitted < 0
    share = max(0, share + p.load_backdriven_extra);
end
y = y * max(0, at) * fall + share * abs(transmitted);
end
