//! A hanging chain of N point masses on N rods. The declarations for several N differ in that number alone.
//!
//! Facts: N = 2 is the double pendulum; the metric is `g_jk = (N + 1 - max(j, k)) m l^2 cos(theta_j - theta_k)`.

dalembert::model_file!("src/chain2.dal");
dalembert::model_file!("src/chain3.dal");
dalembert::model_file!("src/chain4.dal");
dalembert::model_file!("src/chain8.dal");
dalembert::model_file!("src/chain16.dal");
