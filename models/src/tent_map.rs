//! Three squares that are crossed from left to right, and whose first return map is the tent map: a system of three modes
//! whose every motion is trivial, and chaos.
//!
//! Fact: the square `first` is entered at heights `y, T(y), T(T(y)), ..`, `T` the tent map. Source: W. Clark, thesis, Example IV.28.

dalembert::model_file!("src/tent_map.dal");
