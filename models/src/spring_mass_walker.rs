//! A walker: a point mass on two massless springs as legs. The modes of single and double support have different
//! coordinates.
//!
//! Facts: a leg lands and leaves at its rest length, so that the energy is constant from step to step. In double
//! support, both springs push. Source: H. Geyer, A. Seyfarth and R. Blickhan, *Compliant leg behaviour explains basic
//! dynamics of walking and running* (2006); W. Clark, thesis, section 2.3, for systems of this kind.

dalembert::model_file!("src/spring_mass_walker.dal");
