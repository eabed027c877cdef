//! Layout of help texts, and their remarks and examples.

/// Order of a help text: purpose, first example, usage, flags, remarks and further examples.
pub const TEMPLATE: &str =
    "{about-with-newline}\n{before-help}{usage-heading} {usage}\n\n{all-args}{after-help}";

pub const LIST: &str = "More examples:
  dalembert list --json models.json";

pub const DERIVE: &str = "More examples:
  dalembert derive rolling_disk --format latex > rolling_disk.tex
  dalembert derive chaplygin_sleigh --format json
  dalembert derive chaplygin_sleigh --bracket 'x,momentum(theta)'
  dalembert derive rolling_disk --jacobiator 'x,momentum(theta),momentum(phi)'
  dalembert derive rolling_disk --group 'partial(x),partial(y)'
  dalembert derive chaplygin_sleigh --group 'partial(x),partial(y),partial(theta) - y*partial(x) + x*partial(y)'";

pub const CHECK: &str = "More examples:
  dalembert check rolling_disk --json findings.json
  dalembert check rolling_disk --certificate proofs.json
  dalembert check rimless_wheel_five --bendixson
  python3 python/check_certificate.py proofs.json";

pub const SIMULATE: &str =
    "Numbers may be multiples of pi: pi/2, -3*pi/4, 2pi. If a name is repeated, its last value is used.

More examples:
  dalembert simulate rolling_disk
  dalembert simulate rolling_disk --until 40 --plot momenta.svg --axes p_theta,p_phi
  dalembert simulate rolling_disk --set ta=0.3 --initial phi=pi/3,theta_dot=12
  dalembert simulate rolling_disk --impacts 50 --law leading_edge=newton:0.5 --json -
  dalembert simulate rolling_disk --until 40 --max-step 0.05
  dalembert simulate rolling_disk --verify
  dalembert simulate double_pendulum --integrator gauss6 --step 0.01 --until 1000
  dalembert simulate chaplygin_sleigh --integrator dla4 --step pi/200
  dalembert simulate bouncing_ball --q 1 --qdot 0 --until 10 --csv ball.csv
  dalembert simulate bouncing_ball --law newton:0.5 --rest contact --until 10";

pub const ACCURACY: &str = "The error is the largest difference of a position from the reference run, at 64 equally spaced times and at the \
end, relative to the largest absolute value of that coordinate (for an angle, at least 1). Times are measured on \
this machine. Exit status: 0, or 1 if the reference fails its check or no integrator reaches the error of \
--wanted.

More examples:
  dalembert accuracy rolling_disk --until 2 --wanted 1e-9
  dalembert accuracy chaplygin_sleigh --integrator dop853 --integrator taylor --plot sleigh.svg";

pub const EVAL: &str = "Input: a JSON array of states, {\"q\": [..], \"qdot\": [..]} or {\"q\": [..], \"p\": [..]}, with \"t\" if the \
model depends on time. Numbers may be decimal strings. Output: an array of the same length. For a state at which \
a quantity does not exist, the entry is {\"error\": ..} and the exit status is 1.

More examples:
  dalembert eval rolling_disk --set m=2 --newton 0.5 --input states.json";

pub const STABILITY: &str = "Each case has a right answer: a closed form, an exact count or a class of outcome. The cases of dalembert belong \
to the package `dalembert-stability`. Exit status: 0 every case passes or is pending, 1 some case fails.

More examples:
  cargo run --release -p dalembert-stability -- stability --section A --integrator dopri5
  cargo run --release -p dalembert-stability -- stability --case C11 --case C13 --html report.html";
