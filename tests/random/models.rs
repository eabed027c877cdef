//! Declarations drawn at random by `tests/random/emitted.rs`; `ACCEPT=1` draws them anew.

dalembert::model! {
    pub Random0 {
        coordinates { x0; x1; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (2/3)/2*dot(x0)^2 + (2 + sin(x1))/2*dot(x1)^2 + ((0)*dot(x0) + ((6/4)*t*tanh(x0) + (-6/4)*cos(x0 - x1)*tanh(x1) + (-4/4))*dot(x1))^2/2 + (((3/4) + (1/4)*exp(-x0^2)*atan2(x0, 2 + x0^2))*dot(x0) + (0)*dot(x1))^2/2 + ((-1/4) + (-1/4)*atan2(x0, 2 + x0^2))*dot(x0) + ((4/4)*cos(x1 - x1) + (1/4) + (4/4)*sin(2*x1))*dot(x1) - ((2/4) + (4/4)*sqrt(1 + x0^2));
        forces { forces_0: (-c*dot(x1) + (1/4)*sin(2*x1)*exp(-x0^2))*d(x0); }
        impacts { impacts_0: x1 <= 0 + 2 + (-2/4)*tanh(x0)*c + (4/4) + (-5/4)*b => impact_plastic; impacts_1: x1 + (-4/4) + (-1/4)*c*cos(x0 - x0) + (-6/4)*sqrt(1 + x0^2) >= -1 => impact_plastic; }
    }
}

dalembert::model! {
    #[global]
    pub Random1 {
        coordinates { x2: angle; x3; x0: angle; x1; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (1 + x3^2)/2*dot(x0)^2 + (2 + sin(x1))/2*dot(x1)^2 + a/2*dot(x2)^2 + (1 + x3^2)/2*dot(x3)^2 + (((2/4)*t*sin(2*x3) + (-1/4)*cos(x2 - x2)*exp(-x1^2))*dot(x0) + ((4/4)*exp(-x3^2)*atan2(sin(x2), 2 + x3^2))*dot(x1) + ((5/4)*atan2(sin(x2), 2 + sin(x0)^2)*sin(x2) + (6/4)*tanh(x1)*x1 + (-1/4)*b*sin(x0))*dot(x2) + ((1/4)*sqrt(1 + x1^2))*dot(x3))^2/2 + (((-4/4) + (6/4))*dot(x0) + ((6/4) + (-5/4)*t*tanh(x1))*dot(x1) + ((3/4)*sin(2*x1) + (6/4)*exp(-sin(x0)^2)*sqrt(1 + sin(x0)^2))*dot(x2) + ((1/4)*tanh(x3))*dot(x3))^2/2 - ((-3/4) + (-4/4));
        constraints { constraints_0: d(x0 + 0) = 0; }
        forces { forces_0: (-c*abs(dot(x0))*dot(x0) + 0)*d(x0); }
    }
}

dalembert::model! {
    #[global]
    pub Random2 {
        coordinates { x0; x1: angle; x2; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = a/2*dot(x0)^2 + a/2*dot(x1)^2 + (7/3)/2*dot(x2)^2 - (0);
        constraints { constraints_0: d(x0 + (-4/4)*atan2(x2, 2 + sin(x1)^2)*tanh(x2)) = 0; constraints_1: d(x1 + (3/4)*c*c + (5/4)*sqrt(1 + x2^2)*sin(2*x2)) = 0; }
        forces { forces_0: (-c*abs(dot(x0))*dot(x0) + (6/4)*sqrt(1 + x2^2) + (2/4)*tanh(x0))*d(x0); forces_1: (-c*abs(dot(x1))*dot(x0) + (-4/4)*sin(x1)*tanh(sin(x1)) + (2/4)*t*sqrt(1 + x0^2) + (3/4)*tanh(sin(x1))*t)*d(x0); }
        impacts { impacts_0: x2 + (-5/4) >= -0 => totally_plastic; }
    }
}

dalembert::model! {
    pub Random3 {
        coordinates { x0; x1: angle; x2; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (1 + x2^2)/2*dot(x0)^2 + (1 + x2^2)/2*dot(x1)^2 + (8/3)/2*dot(x2)^2 + ((0)*dot(x0) + (0)*dot(x1) + ((-6/4)*t + (-6/4)*b + (-1/4)*tanh(x2)*sin(2*x1))*dot(x2))^2/2 + (((3/4)*tanh(x0))*dot(x0) + (0)*dot(x1) + (0)*dot(x2))^2/2 - ((5/4));
        impacts { impacts_0: x2 + 0 >= -0 => elastic; }
    }
}

dalembert::model! {
    #[global]
    pub Random4 {
        coordinates { x1: angle; x2; x3; x0: angle; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = a/2*dot(x0)^2 + (7/3)/2*dot(x1)^2 + (2 + sin(x2))/2*dot(x2)^2 + (3/3)/2*dot(x3)^2 + (((-1/4))*dot(x0) + ((3/4)*sin(2*x1))*dot(x1) + ((-4/4)*exp(-x2^2)*b + (4/4)*cos(x0 - x2))*dot(x2) + ((3/4)*cos(x0 - x0) + (3/4) + (6/4)*exp(-x3^2))*dot(x3))^2/2 - (0);
        constraints { constraints_0: d(x0 + (-1/4)*exp(-sin(x1)^2)*tanh(x2)) = 0; constraints_1: dot(x1) = ((-5/4) + (-3/4)*exp(-sin(x1)^2))*dot(x2) + ((-4/4)*sin(2*x1))*dot(x3) + 0; }
        forces { forces_0: (-c*dot(x3) + (-3/4)*sin(2*x0) + (5/4)*cos(x2 - x3)*x3)*d(x1); }
        impacts { impacts_0: x3 <= 0 + 2 + (1/4)*tanh(sin(x1)) + (3/4)*tanh(sin(x0))*atan2(sin(x0), 2 + sin(x0)^2) + (6/4)*cos(x0 - x2) => totally_plastic; impacts_1: x3 <= 1 + 2 + (5/4)*cos(x2 - x1) when 1 + x3 > (2/4)*sin(2*x0)*t; }
    }
}

dalembert::model! {
    pub Random5 {
        coordinates { x1: angle; x2; x0; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = a/2*dot(x0)^2 + (2 + sin(x1))/2*dot(x1)^2 + a/2*dot(x2)^2 + ((0)*dot(x0) + ((4/4) + (-5/4) + (3/4))*dot(x1) + ((6/4)*t*tanh(x2) + (4/4))*dot(x2))^2/2 + (((5/4)*x0)*dot(x0) + ((-5/4) + (1/4) + (-2/4)*tanh(x2))*dot(x1) + ((4/4)*atan2(x2, 2 + sin(x1)^2) + (-4/4) + (-1/4)*c*t)*dot(x2))^2/2 + ((-2/4)*cos(x0 - x1) + (-5/4)*atan2(x0, 2 + x0^2)*c + (2/4)*b*sin(2*x0))*dot(x0) + ((-5/4)*sqrt(1 + x0^2)*t + (-3/4)*atan2(sin(x1), 2 + x0^2)*b)*dot(x1) + (0)*dot(x2) - (0);
        constraints { constraints_0: d(x0 + 0) = 0; constraints_1: (2 + cos(x1))*(d(x1) + ((-2/4)*atan2(x2, 2 + x0^2)*b)*d(x2)) = 0; }
        impacts { impacts_0: x2 <= 0 + 2 + (-4/4)*t => nonholonomic_plastic; impacts_1: x2 <= 1 + 2 + 0 when 1 + x2 > (1/4) + (5/4)*sin(2*x1)*tanh(x0) + (-1/4) => nonholonomic_plastic; }
    }
}

dalembert::model! {
    #[global]
    pub Random6 {
        coordinates { x0; x1: angle; x2; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (2 + sin(x0))/2*dot(x0)^2 + (2 + sin(x1))/2*dot(x1)^2 + (2/3)/2*dot(x2)^2 - (0);
        constraints { constraints_0: dot(x0) = ((-3/4)*cos(x0 - x2))*dot(x1) + (0)*dot(x2) + 0; constraints_1: d(x1) + ((-2/4)*atan2(x2, 2 + sin(x1)^2)*b + (-6/4)*sqrt(1 + x2^2))*d(x2) + ((-1/4) + (-2/4)*cos(x1 - x1))*d(t) = 0; }
        forces { forces_0: (-c*dot(x2) + 0)*d(x1); forces_1: (-c*abs(dot(x0))*dot(x2) + (3/4) + (-3/4) + (3/4)*exp(-sin(x1)^2)*atan2(sin(x1), 2 + x2^2))*d(x2); }
    }
}

dalembert::model! {
    pub Random7 {
        coordinates { x0: angle; x1; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (2/3)/2*dot(x0)^2 + (4/3)/2*dot(x1)^2 - ((-4/4)*exp(-x1^2)*tanh(sin(x0)) + (-3/4)*cos(x0 - x0)*tanh(sin(x0)) + (-6/4)*sin(2*x1)*t);
        constraints { constraints_0: (2 + cos(x0))*(d(x0) + ((4/4) + (2/4)*t*sqrt(1 + sin(x0)^2))*d(x1)) = 0; }
        impacts { impacts_0: x1 + (4/4)*atan2(sin(x0), 2 + sin(x0)^2)*t + (-2/4) + (-5/4)*cos(x0 - x0)*atan2(sin(x0), 2 + sin(x0)^2) >= -0 when 1 + x1 > (-2/4)*tanh(sin(x0)) + (-4/4)*atan2(sin(x0), 2 + sin(x0)^2) => nonholonomic_plastic; }
    }
}

dalembert::model! {
    pub Random8 {
        coordinates { x0; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (6/3)/2*dot(x0)^2 + (((2/4) + (-6/4)*exp(-x0^2) + (6/4))*dot(x0))^2/2 + (((3/4)*atan2(x0, 2 + x0^2) + (-6/4)*cos(x0 - x0))*dot(x0))^2/2 - ((-5/4));
        forces { forces_0: (-c*dot(x0) + 0)*d(x0); forces_1: (-c*abs(dot(x0))*dot(x0) + (-5/4)*exp(-x0^2))*d(x0); }
        impacts { impacts_0: x0 <= 0 + 2 + (-6/4); }
    }
}

dalembert::model! {
    #[global]
    pub Random9 {
        coordinates { x0; x1: angle; x2; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = a/2*dot(x0)^2 + a/2*dot(x1)^2 + (2 + sin(x2))/2*dot(x2)^2 + (((-6/4)*tanh(sin(x1)) + (-6/4)*b*cos(x2 - x2))*dot(x0) + ((-6/4) + (-1/4)*x2)*dot(x1) + ((5/4)*sqrt(1 + sin(x1)^2)*t + (2/4)*t + (-6/4))*dot(x2))^2/2 + (((-4/4))*dot(x0) + ((-4/4)*sqrt(1 + x0^2))*dot(x1) + ((3/4) + (-2/4) + (-6/4))*dot(x2))^2/2 - ((3/4) + (-6/4)*atan2(sin(x1), 2 + sin(x1)^2)*x0 + (-3/4)*cos(x1 - x0)*sin(2*x0));
        constraints { constraints_0: d(x0 + (-2/4)*x2*t + (-2/4)*cos(x2 - x1)*tanh(x2) + (2/4)*t) = 0; constraints_1: d(x1) + (0)*d(x2) + (0)*d(t) = 0; }
        impacts { impacts_0: x2 + (2/4)*b*cos(x1 - x0) >= -0 => totally_plastic; }
    }
}

dalembert::model! {
    #[global]
    pub Random10 {
        coordinates { x1; x0: angle; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = (2 + sin(x0))/2*dot(x0)^2 + (2 + sin(x1))/2*dot(x1)^2 + (((-2/4)*tanh(sin(x0))*cos(x1 - x0) + (5/4)*cos(x1 - x0))*dot(x0) + ((-4/4) + (2/4)*sin(x0)*atan2(x1, 2 + sin(x0)^2) + (4/4)*tanh(x1))*dot(x1))^2/2 + (((1/4))*dot(x0) + ((1/4) + (-2/4)*sin(2*x1)*sin(2*x0))*dot(x1))^2/2 + ((-2/4)*tanh(sin(x0))*atan2(x1, 2 + sin(x0)^2))*dot(x0) + ((-6/4))*dot(x1) - (0);
        constraints { constraints_0: d(x0) + (0)*d(x1) + (0)*d(t) = 0; }
        forces { forces_0: (-c*dot(x1) + (-5/4))*d(x0); forces_1: (-c*dot(x0) + (4/4)*sqrt(1 + x1^2)*sin(2*x0) + (-3/4)*x1 + (6/4)*sin(2*x1))*d(x1); }
    }
}

dalembert::model! {
    pub Random11 {
        coordinates { x0; x1: angle; x2; x3; }
        parameters { a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3; }
        lagrangian = a/2*dot(x0)^2 + (2 + sin(x1))/2*dot(x1)^2 + a/2*dot(x2)^2 + (2 + sin(x3))/2*dot(x3)^2 + (((-4/4) + (2/4)*tanh(sin(x1)))*dot(x0) + (0)*dot(x1) + ((-5/4)*sin(x1) + (2/4))*dot(x2) + ((-1/4)*cos(x0 - x1)*sin(2*x2) + (3/4))*dot(x3))^2/2 + (((-1/4)*exp(-x2^2)*tanh(x3) + (1/4)*t + (-5/4))*dot(x0) + ((1/4) + (-4/4)*sqrt(1 + sin(x1)^2))*dot(x1) + ((-3/4)*sqrt(1 + x0^2)*sin(x1) + (3/4)*exp(-sin(x1)^2))*dot(x2) + ((-4/4)*atan2(x0, 2 + sin(x1)^2)*t)*dot(x3))^2/2 + ((-4/4)*sqrt(1 + x0^2)*sin(2*x1) + (-4/4)*tanh(x3)*atan2(x2, 2 + sin(x1)^2))*dot(x0) + ((-6/4)*sqrt(1 + x2^2)*a)*dot(x1) + ((4/4)*b + (-6/4)*tanh(x2)*tanh(sin(x1)) + (4/4)*t*sin(2*x2))*dot(x2) + ((6/4)*a*sin(2*x2) + (1/4)*x0*atan2(x0, 2 + x0^2) + (4/4)*sin(2*x1)*sin(2*x3))*dot(x3) - ((-3/4));
        forces { forces_0: (-c*dot(x2) + (5/4)*sin(2*x0) + (-2/4)*exp(-x0^2) + (4/4))*d(x3); forces_1: (-c*abs(dot(x1))*dot(x2) + (5/4) + (4/4))*d(x2); }
    }
}
