//! Three squares that the motion crosses from left to right, with the tent map as first return map. The motion in each
//! of the three modes is trivial, and the system is chaotic.
//!
//! Fact: the motion enters the square `first` at the heights `y, T(y), T(T(y)), ..`, where `T` is the tent map. Source:
//! W. Clark, thesis, Example IV.28.

dalembert::model_file!("src/tent_map.dal");
