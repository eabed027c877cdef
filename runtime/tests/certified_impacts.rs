//! Certified motion across impacts contains references of many digits, with boxes that stay narrow, and is lost where impacts cannot
//! be told.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;

use dalembert::certified::{CertifiedRun, Reason};
use dalembert::extended::{At, ExtendedSimulation};
use dalembert::numbers::Interval;
use dalembert::{Impacting, Scene, StateVector, System, Variational};

dalembert::model! {
    /// A ball over a floor.
    pub Ball {
        coordinates { x; }
        parameters { g > 0 = 1; e in [0, 1] = 3/4; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => newton(e); }
    }
}

dalembert::model! {
    /// A disk that rolls upright on an elliptical table (W. Clark, thesis, section 6.4).
    pub RollingDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 1/400; R > 0 = 1/100; I > 0 = 1/8000000; J > 0 = 1/16000000; ta > 0 = 3/20; tb > 0 = 1/5; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints { rolling_x: d(x) - R*cos(phi)*d(theta) = 0; rolling_y: dot(y) = R*sin(phi)*dot(theta); }
        frame { roll: d(theta); turn: d(phi); }
        impacts {
            leading_edge: table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
    }
}

dalembert::model! {
    /// A sleigh on a blade, between the edges of an elliptical table (W. Clark, thesis, section 7.5).
    pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 1; a = 1/5; len > 0 = 1/4; ta > 0 = 2; tb > 0 = 1; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
        impacts {
            front_tip: table(x + len*cos(theta), y + len*sin(theta)) >= 0;
            back_tip: table(x - len*cos(theta), y - len*sin(theta)) >= 0;
        }
    }
}

/// The doubles on both sides of a decimal number.
fn about(digits: &str) -> Interval {
    let nearest: f64 = digits.parse().unwrap();
    Interval::new(nearest.next_down(), nearest.next_up())
}

fn point(value: f64) -> Interval {
    Interval::point(value)
}

/// Impacts of a reference: time, surface, positions.
struct Reference {
    t: &'static str,
    surface: usize,
    q: &'static [&'static str],
}

/// Whether an enclosure meets the doubles about a reference, and how wide it is.
fn check(found: Interval, digits: &str, what: &str) -> f64 {
    let reference = about(digits);
    assert!(
        found.hull(reference).width() <= found.width() + reference.width(),
        "{what}: {digits} is not in {found:?}"
    );
    found.width()
}

fn follow<S: Variational + Impacting>(
    mut run: CertifiedRun<'_, S>,
    references: &[Reference],
    name: &str,
) -> f64 {
    let begun = std::time::Instant::now();
    let (mut count, mut widest) = (0, 0.0_f64);
    let ended = run.run(1e3, |impact| {
        let reference = &references[count];
        assert_eq!(impact.surface, reference.surface, "impact {}", count + 1);
        let mut width = check(impact.time, reference.t, "time");
        for (i, digits) in reference.q.iter().enumerate() {
            width = width.max(check(impact.after(i), digits, "place"));
        }
        println!(
            "{name}: impact {} at {:?}: width {width:.1e}",
            count + 1,
            impact.time
        );
        widest = widest.max(width);
        count += 1;
        match count == references.len() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    println!(
        "{name}: {} steps, {:?}, {ended:?}",
        run.steps(),
        begun.elapsed()
    );
    assert_eq!(count, references.len());
    widest
}

fn state<S: System>(system: &S, q: &[f64], qdot: &[f64]) -> S::State {
    let vector = |values: &[f64]| {
        let mut vector = S::Vector::zeros();
        vector.as_mut_slice().copy_from_slice(values);
        vector
    };
    system
        .state_unchecked(0.0, &vector(q), &vector(qdot))
        .unwrap()
}

/// The time of the `n`-th impact of a ball dropped from the height 1, in numbers of 60 digits.
fn bounce(n: i32) -> f64 {
    let e = 0.75_f64;
    // `sqrt(2) (1 + 2 (e + .. + e^(n-1)))`, whose sum is exact enough in doubles for a test of 1e-15.
    core::f64::consts::SQRT_2 * (1.0 + 2.0 * e * (1.0 - e.powi(n - 1)) / (1.0 - e))
}

#[test]
fn a_ball_is_held_to_its_hundredth_bounce() {
    let ball = Ball::default();
    let start = [1.0, 0.0];
    let mut run = CertifiedRun::new(&ball, 0.0, |i| point(start[i]));
    let begun = std::time::Instant::now();
    let mut count = 0;
    let ended = run.run(20.0, |impact| {
        count += 1;
        let exact = bounce(count);
        assert!(
            impact
                .time
                .widened(8.0 * f64::EPSILON * exact)
                .contains(point(exact)),
            "{count}: {:?}, {exact}",
            impact.time
        );
        if count % 10 == 0 {
            println!(
                "ball: bounce {count}: time {:?} width {:.1e}",
                impact.time,
                impact.time.width()
            );
        }
        match count {
            100 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    println!(
        "ball: {} steps, {:?}, {ended:?}",
        run.steps(),
        begun.elapsed()
    );
    assert_eq!(count, 100, "{ended:?}");
}

/// `tests/reference/rolling_disk_trajectories.json`, the elastic case on an ellipse.
const DISK: [Reference; 20] = [
    Reference {
        t: "1.8834069201978126505988357392325",
        surface: 0,
        q: &[
            "-0.0350547689392957293838321635146",
            "0.183918275638687730568785620165",
            "18.8340692019781265059883573923",
            "1.94747771083445914935108883949",
        ],
    },
    Reference {
        t: "2.4998527525985378965502733002653",
        surface: 1,
        q: &[
            "0.00907256329404222871485053826415",
            "0.189602754955484894096907928419",
            "12.7646744287499951319629397478",
            "4.59193631504278197388391840568",
        ],
    },
    Reference {
        t: "4.6114551130628242534273315974246",
        surface: 0,
        q: &[
            "0.134654195370702290190425913875",
            "0.0526093826007478293731496901152",
            "33.8696581116398169343220711447",
            "6.31677088156866652831628963339",
        ],
    },
    Reference {
        t: "4.774580555961511605467865198063",
        surface: 1,
        q: &[
            "0.132755705343585388336922743933",
            "0.0608154106778754850000004309121",
            "32.6876980547662581959090113677",
            "3.56271332721848498207140716521",
        ],
    },
    Reference {
        t: "7.1832712511234290194894795209083",
        surface: 0,
        q: &[
            "0.0938110151568889793181628939215",
            "-0.140967390981537767820710350349",
            "56.762677240593436558382309161",
            "5.4807471700606162765054286157",
        ],
    },
    Reference {
        t: "7.4224157767977408638723716130303",
        surface: 1,
        q: &[
            "0.102595229263527740052547290744",
            "-0.129215365400319360641326007976",
            "54.666597233443405577426289341",
            "2.66027881854221743733953847324",
        ],
    },
    Reference {
        t: "9.1542231629618735378292150860797",
        surface: 0,
        q: &[
            "-0.0426249889644555425748836484681",
            "-0.18092791233689514150257150063",
            "71.9721938321062118671399517866",
            "4.30709942886987998871891717767",
        ],
    },
    Reference {
        t: "10.597154583849014085385054455171",
        surface: 1,
        q: &[
            "-0.120237154798200860458290995753",
            "-0.0972344900910908030944535137507",
            "57.5731415020423080748794330538",
            "6.61311010749483332305973630238",
        ],
    },
    Reference {
        t: "10.959792551433894191312248151078",
        surface: 0,
        q: &[
            "-0.109406484217558285884300402157",
            "-0.118426023870035939370663838663",
            "61.0070290402197941901498546285",
            "3.75661998442892651997285409901",
        ],
    },
    Reference {
        t: "12.704334402187527243205902803767",
        surface: 1,
        q: &[
            "-0.139635618342368761196351463214",
            "0.0147382368589847409229648130265",
            "43.5876078523989133850006168163",
            "6.11460458087773695271610205825",
        ],
    },
    Reference {
        t: "12.967548226582466309395150081692",
        surface: 0,
        q: &[
            "-0.140054258804942818454735802038",
            "-0.00161644706687667860002852653796",
            "45.9475917330724148141090448397",
            "3.25898938095540853048816686963",
        ],
    },
    Reference {
        t: "14.698801697928282885118293598117",
        surface: 1,
        q: &[
            "-0.102762017183552202991836314057",
            "0.128900571884785819252535360696",
            "28.6610858679454954508721244434",
            "5.6091656766918925477073874141",
        ],
    },
    Reference {
        t: "15.101357615758903417842797680969",
        surface: 0,
        q: &[
            "-0.116240490848238985092665176017",
            "0.105775570231458032920864071792",
            "32.5150994827840492899406929523",
            "2.76018049266836321439944570971",
        ],
    },
    Reference {
        t: "16.469092933690447681404931845009",
        surface: 1,
        q: &[
            "-0.04038388295562448684735469207",
            "0.181876920923274366256713755097",
            "18.8706015796228219939332273413",
            "5.097022329453942908300068874",
        ],
    },
    Reference {
        t: "18.065267518231288602868465160889",
        surface: 0,
        q: &[
            "0.0927657057526950415393640594034",
            "0.142189104561288530248975793948",
            "34.8160878791412954520745974199",
            "6.88997898365978196455923850375",
        ],
    },
    Reference {
        t: "18.399507284668501285614221055413",
        surface: 1,
        q: &[
            "0.0776312044806553358453256214988",
            "0.158020596753168925562186461196",
            "31.6795096230400569177437120895",
            "4.06058636513231939941650336478",
        ],
    },
    Reference {
        t: "20.87348517903287025295132566641",
        surface: 0,
        q: &[
            "0.135744408447182564126154137214",
            "-0.047224100291014135419350763001",
            "56.4085146100343543383432418066",
            "5.91602967234308320984032962371",
        ],
    },
    Reference {
        t: "21.033621552080152690440134798418",
        surface: 1,
        q: &[
            "0.137131918282817918114277396887",
            "-0.0391938140618479987597460087392",
            "55.2663219541689222183057381044",
            "3.16655769552928489332266138656",
        ],
    },
    Reference {
        t: "23.251477935755318872727421366824",
        surface: 0,
        q: &[
            "0.0111210280558698903669179336692",
            "-0.1894036321557765812978865812",
            "77.4348196568909036966925580807",
            "4.8621921694703202511521627577",
        ],
    },
    Reference {
        t: "23.767117735750162726629874597097",
        surface: 1,
        q: &[
            "-0.0251604533873143190677178043096",
            "-0.186896238017181498481573390046",
            "72.3977945253887990252680735105",
            "7.56617891630624414649988352508",
        ],
    },
];

/// `tests/reference/chaplygin_sleigh_trajectories.json`, the first elastic billiard.
const SLEIGH: [Reference; 20] = [
    Reference {
        t: "1.009470559218937068172604429",
        surface: 0,
        q: &[
            "0.756629895651280423065586878",
            "0.6884013535098720696761255873",
            "0.9581174331832361599236410557",
        ],
    },
    Reference {
        t: "2.479298090213280124797755153",
        surface: 1,
        q: &[
            "0.07700962905849279236826624651",
            "-0.7575051159840131392525346867",
            "1.324615304386416358676543125",
        ],
    },
    Reference {
        t: "3.838623374396694704574244544",
        surface: 0,
        q: &[
            "0.3034764090931863988680448994",
            "0.7376744263763410680510526523",
            "1.507337478529750097689080883",
        ],
    },
    Reference {
        t: "5.163939242993815550432691131",
        surface: 1,
        q: &[
            "0.3443203377485740222049505901",
            "-0.7341931821688216015367295643",
            "1.698950040896328816264303963",
        ],
    },
    Reference {
        t: "6.556404482534240392441226939",
        surface: 0,
        q: &[
            "-0.02890693972047519088758232331",
            "0.7634448478010385663505025373",
            "1.919933340097141295084873053",
        ],
    },
    Reference {
        t: "8.25452618741307335308907856",
        surface: 1,
        q: &[
            "1.030132175139582259044210834",
            "-0.646324387321273855205316467",
            "2.551405532105761212035003888",
        ],
    },
    Reference {
        t: "10.17009666614681319165496766",
        surface: 0,
        q: &[
            "-0.6059048794121074804844435873",
            "-0.7671978480232211932812035974",
            "3.773331499283475868357674367",
        ],
    },
    Reference {
        t: "12.06154790047527823479501158",
        surface: 1,
        q: &[
            "0.9661259500163904219466084007",
            "0.6377759844321971258492996242",
            "3.982837027157004533570110307",
        ],
    },
    Reference {
        t: "13.88147588656568898401003872",
        surface: 0,
        q: &[
            "-0.4985927310090921545780315837",
            "-0.7769651525602470432444629248",
            "3.845432805908413226219821379",
        ],
    },
    Reference {
        t: "15.96833381786449201816693979",
        surface: 1,
        q: &[
            "1.336015600114100726633674551",
            "-0.505677911214301803137074632",
            "2.619898487892105785366401999",
        ],
    },
    Reference {
        t: "17.59937213331294855143481069",
        surface: 0,
        q: &[
            "0.2374124966746725420617394265",
            "0.7687587812029518416024053771",
            "1.984630921782489596863405973",
        ],
    },
    Reference {
        t: "18.96968062044274594318067888",
        surface: 1,
        q: &[
            "0.7726539849501368582458256373",
            "-0.6670645836768886740719906227",
            "1.864676379907186416183716971",
        ],
    },
    Reference {
        t: "20.26742310694919099163979943",
        surface: 0,
        q: &[
            "0.4062117921769193309086887911",
            "0.7403726016695936307764765318",
            "1.789824577194644122136745996",
        ],
    },
    Reference {
        t: "21.58050306256715834561925052",
        surface: 1,
        q: &[
            "0.8467234842788355732067503697",
            "-0.6514126515178394065367763814",
            "1.973578271169923328362779437",
        ],
    },
    Reference {
        t: "23.15299974694030421480506221",
        surface: 0,
        q: &[
            "-0.08515927531229211890629647165",
            "0.8039233434335938515639778488",
            "2.28895362521413238975807186",
        ],
    },
    Reference {
        t: "25.13813125067661920313383511",
        surface: 1,
        q: &[
            "1.509244867337563948347821045",
            "0.3875855574823970307278075505",
            "3.604583870081412532116531333",
        ],
    },
    Reference {
        t: "26.64278657904309033544577757",
        surface: 0,
        q: &[
            "0.5956396233260530790671516422",
            "-0.7280414057525933687512604753",
            "4.398413856041173186762203012",
        ],
    },
    Reference {
        t: "27.93346975214733302471998421",
        surface: 1,
        q: &[
            "0.8275438162689480472535243598",
            "0.660255713289966032008372359",
            "4.710181216353719562567610413",
        ],
    },
    Reference {
        t: "29.12673920427488799923287894",
        surface: 0,
        q: &[
            "1.096021436127054326344398677",
            "-0.5723712836981543924036522926",
            "5.124724224231706776080728864",
        ],
    },
    Reference {
        t: "31.2125169472522206237858096",
        surface: 1,
        q: &[
            "-0.4245567030327652146871416176",
            "0.8718434617288579525377303773",
            "5.993506203829974182941223582",
        ],
    },
];

#[test]
fn a_rolling_disk_is_held_over_twenty_impacts() {
    let disk = RollingDisk::default();
    let half = Interval::pi() * point(0.5);
    let start = [
        point(0.0),
        point(0.0),
        point(0.0),
        half,
        point(10.0),
        about("0.2"),
    ];
    let ranges = ["0.0025", "0.01", "1.25e-7", "6.25e-8", "0.15", "0.2"];
    let mut run = CertifiedRun::new(&disk, 0.0, |i| start[i]);
    for (i, range) in ranges.into_iter().enumerate() {
        run = run.with_parameter(i, about(range));
    }
    follow(run, &DISK, "disk");
}

#[test]
fn a_sleigh_is_held_over_twenty_impacts() {
    let sleigh = Sleigh::default();
    let start = [0.0, 0.0, 0.5, 1.0, 0.5];
    let run = CertifiedRun::new(&sleigh, 0.0, |i| point(start[i])).with_parameter(2, about("0.2"));
    follow(run, &SLEIGH, "sleigh");
}
