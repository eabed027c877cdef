//! A point mass on two massless springs for legs that walks: single and double support, with coordinates of their own.
//!
//! Facts: a leg lands and leaves at its rest length, so that nothing is lost and the energy is constant from step to step; in
//! double support two springs push. Source: H. Geyer, A. Seyfarth and R. Blickhan, *Compliant leg behaviour explains basic dynamics of
//! walking and running* (2006); W. Clark, thesis, section 2.3, for systems of this kind.

dalembert::model_file!("src/spring_mass_walker.dal");
