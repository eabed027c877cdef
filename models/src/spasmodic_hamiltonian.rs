//! A Hamiltonian system between two walls. Its motion escapes in finite time. Energy and volume are conserved, and yet
//! impacts accumulate.
//!
//! `H = p_x (1 + x^2) + p_y^2 x/2` is degenerate and has no Lagrangian, so that its field is declared.
//!
//! Facts: from `x = 0`, `y = y0` and `p_y > 0`, the motion is `x = tan(t)`. The n-th impact is at the time
//! `acos(exp(-(n - y0)/p_y))` with the initial `p_y`; the impacts accumulate at `pi/2`. Source: W. Clark and A. Bloch,
//! Example 6. The walls are `y = 0` and `y = 1`; the paper prints `S = {0, 1} x R`.

dalembert::model_file!("src/spasmodic_hamiltonian.dal");
