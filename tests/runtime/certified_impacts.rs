//! Certified motion across impacts contains references of many digits, with boxes that stay narrow.
//!
//! Stored references are those of `tests/reference`. Parameters that are not doubles are given as ranges that contain them.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;
use std::time::Instant;

use dalembert::certified::CertifiedRun;
use dalembert::extended::{At, Extended, ExtendedSimulation, Impact};
use dalembert::numbers::{Interval, Numbers, Row};
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

dalembert::model! {
    /// A point on a spring between a floor, which takes a third of its speed, and a wall that swings.
    pub Swing {
        coordinates { x; }
        parameters { w = 1; }
        lagrangian = dot(x)^2/2 - x^2/2;
        impacts { floor: x >= -1/3 => newton(2/3); wall: x <= 1 + w*sin(t)/10; }
    }
}

dalembert::model! {
    /// A walker on a slope whose foot slips, in dimensionless form (W. Clark, thesis, section 4.2).
    pub Walker {
        coordinates { theta; xi; eta; }
        parameters { mu > 0 = 5/2; eps > 0 = 1/2; alpha = 2/5; delta > 0 = 2/5; }
        let foot = eta + xi*cos(theta);
        let weight = mu/(1 + mu*sin(theta)^2);
        field {
            dot(theta) = eps*xi;
            dot(xi) = weight*(sin(theta)*(cos(alpha) - eps*xi^2*cos(theta)) - cos(theta)*foot);
            dot(eta) = sin(alpha) - foot;
        }
        impacts {
            step: theta >= -delta => reset {
                theta = theta + 2*delta;
                xi = cos(2*delta)*xi;
                eta = eta + cos(delta)*(1 - cos(2*delta))*xi;
            };
        }
    }
}

dalembert::model! {
    /// Point mass that walks on spring legs (H. Geyer, A. Seyfarth and R. Blickhan, 2006).
    pub SpringWalker {
        parameters { k > 0 = 17.84; alpha in [0, 1.5] = 1.2043; }
        coordinates { x; y; }
        let spring(foot) = k/2*(sqrt((x - foot)^2 + y^2) - 1)^2;
        modes {
            single {
                coordinates { foot; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(foot)^2)/2 - y - spring(foot);
                constraints { stands: d(foot) = 0; }
            }
            double {
                coordinates { front; back; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(front)^2 + dot(back)^2)/2 - y - spring(front) - spring(back);
                constraints { stands_in_front: d(front) = 0; stands_behind: d(back) = 0; }
            }
        }
        transitions {
            touch_down: single -> double when y <= sin(alpha) when x > foot => reset {
                front = x + cos(alpha);
                back = foot;
                dot(front) = 0;
                dot(back) = 0;
            };
            lift_off: double -> single when (x - back)^2 + y^2 >= 1 => reset { foot = front; dot(foot) = 0; };
        }
    }
}

/// `bouncing_ball_trajectories.json`, the first case.
const BOUNCES: [Reference; 30] = [
    Reference {
        t: "1.4142135623730950488016887242097",
        surface: 0,
        after: &["0", "1.06066017177982128660126654316"],
    },
    Reference {
        t: "3.5355339059327376220042218105242",
        surface: 0,
        after: &["0", "0.795495128834865964950949907368"],
    },
    Reference {
        t: "5.1265241636024695519061216252602",
        surface: 0,
        after: &["0", "0.596621346626149473713212430526"],
    },
    Reference {
        t: "6.3197668568547684993325464863121",
        surface: 0,
        after: &["0", "0.447466009969612105284909322894"],
    },
    Reference {
        t: "7.214698876793992709902365132101",
        surface: 0,
        after: &["0", "0.335599507477209078963681992171"],
    },
    Reference {
        t: "7.8858978917484108678297291164428",
        surface: 0,
        after: &["0", "0.251699630607906809222761494128"],
    },
    Reference {
        t: "8.389297152964224486275252104699",
        surface: 0,
        after: &["0", "0.188774722955930106917071120596"],
    },
    Reference {
        t: "8.7668465988760847001093943458912",
        surface: 0,
        after: &["0", "0.141581042216947580187803340447"],
    },
    Reference {
        t: "9.0500086833099798604850010267854",
        surface: 0,
        after: &["0", "0.106185781662710685140852505335"],
    },
    Reference {
        t: "9.262380246635401230766706037456",
        surface: 0,
        after: &["0", "0.0796393362470330138556393790015"],
    },
    Reference {
        t: "9.421658919129467258477984795459",
        surface: 0,
        after: &["0", "0.0597295021852747603917295342511"],
    },
    Reference {
        t: "9.5411179235000167792614438639612",
        surface: 0,
        after: &["0", "0.0447971266389560702937971506883"],
    },
    Reference {
        t: "9.6307121767779289198490381653379",
        surface: 0,
        after: &["0", "0.0335978449792170527203478630163"],
    },
    Reference {
        t: "9.6979078667363630252897338913704",
        surface: 0,
        after: &["0", "0.0251983837344127895402608972622"],
    },
    Reference {
        t: "9.7483046342051886043702556858948",
        surface: 0,
        after: &["0", "0.0188987878008095921551956729466"],
    },
    Reference {
        t: "9.786102209806807788680647031788",
        surface: 0,
        after: &["0", "0.01417409085060719411639675471"],
    },
    Reference {
        t: "9.814450391508022176913440541208",
        surface: 0,
        after: &["0", "0.0106305681379553955872975660325"],
    },
    Reference {
        t: "9.835711527783932968088035673273",
        surface: 0,
        after: &["0", "0.00797292610346654669047317452436"],
    },
    Reference {
        t: "9.8516573799908660614689820223217",
        surface: 0,
        after: &["0", "0.00597969457759991001785488089327"],
    },
    Reference {
        t: "9.8636167691460658815046917841082",
        surface: 0,
        after: &["0", "0.00448477093319993251339116066995"],
    },
    Reference {
        t: "9.8725863110124657465314741054482",
        surface: 0,
        after: &["0", "0.00336357819989994938504337050247"],
    },
    Reference {
        t: "9.8793134674122656453015608464531",
        surface: 0,
        after: &["0", "0.00252268364992496203878252787685"],
    },
    Reference {
        t: "9.8843588347121155693791259022068",
        surface: 0,
        after: &["0", "0.00189201273744372152908689590764"],
    },
    Reference {
        t: "9.8881428601870030124372996940221",
        surface: 0,
        after: &["0", "0.00141900955308279114681517193073"],
    },
    Reference {
        t: "9.8909808792931685947309300378835",
        surface: 0,
        after: &["0", "0.00106425716481209336011137894805"],
    },
    Reference {
        t: "9.8931093936227927814511527957796",
        surface: 0,
        after: &["0", "0.000798192873609070020083534211034"],
    },
    Reference {
        t: "9.8947057793700109214913198642017",
        surface: 0,
        after: &["0", "0.000598644655206802515062650658276"],
    },
    Reference {
        t: "9.8959030686804245265214451655182",
        surface: 0,
        after: &["0", "0.000448983491405101886296987993707"],
    },
    Reference {
        t: "9.8968010356632347302940391415056",
        surface: 0,
        after: &["0", "0.00033673761855382641472274099528"],
    },
    Reference {
        t: "9.8974745109003423831234846234962",
        surface: 0,
        after: &["0", "0.00025255321391536981104205574646"],
    },
];

/// `rolling_disk_trajectories.json`, the elastic case on an ellipse.
const DISK: [Reference; 20] = [
    Reference {
        t: "1.8834069201978126505988357392325",
        surface: 0,
        after: &[
            "-0.0350547689392957293838321635146",
            "0.183918275638687730568785620165",
            "18.8340692019781265059883573923",
            "1.94747771083445914935108883949",
        ],
    },
    Reference {
        t: "2.4998527525985378965502733002653",
        surface: 1,
        after: &[
            "0.00907256329404222871485053826415",
            "0.189602754955484894096907928419",
            "12.7646744287499951319629397478",
            "4.59193631504278197388391840568",
        ],
    },
    Reference {
        t: "4.6114551130628242534273315974246",
        surface: 0,
        after: &[
            "0.134654195370702290190425913875",
            "0.0526093826007478293731496901152",
            "33.8696581116398169343220711447",
            "6.31677088156866652831628963339",
        ],
    },
    Reference {
        t: "4.774580555961511605467865198063",
        surface: 1,
        after: &[
            "0.132755705343585388336922743933",
            "0.0608154106778754850000004309121",
            "32.6876980547662581959090113677",
            "3.56271332721848498207140716521",
        ],
    },
    Reference {
        t: "7.1832712511234290194894795209083",
        surface: 0,
        after: &[
            "0.0938110151568889793181628939215",
            "-0.140967390981537767820710350349",
            "56.762677240593436558382309161",
            "5.4807471700606162765054286157",
        ],
    },
    Reference {
        t: "7.4224157767977408638723716130303",
        surface: 1,
        after: &[
            "0.102595229263527740052547290744",
            "-0.129215365400319360641326007976",
            "54.666597233443405577426289341",
            "2.66027881854221743733953847324",
        ],
    },
    Reference {
        t: "9.1542231629618735378292150860797",
        surface: 0,
        after: &[
            "-0.0426249889644555425748836484681",
            "-0.18092791233689514150257150063",
            "71.9721938321062118671399517866",
            "4.30709942886987998871891717767",
        ],
    },
    Reference {
        t: "10.597154583849014085385054455171",
        surface: 1,
        after: &[
            "-0.120237154798200860458290995753",
            "-0.0972344900910908030944535137507",
            "57.5731415020423080748794330538",
            "6.61311010749483332305973630238",
        ],
    },
    Reference {
        t: "10.959792551433894191312248151078",
        surface: 0,
        after: &[
            "-0.109406484217558285884300402157",
            "-0.118426023870035939370663838663",
            "61.0070290402197941901498546285",
            "3.75661998442892651997285409901",
        ],
    },
    Reference {
        t: "12.704334402187527243205902803767",
        surface: 1,
        after: &[
            "-0.139635618342368761196351463214",
            "0.0147382368589847409229648130265",
            "43.5876078523989133850006168163",
            "6.11460458087773695271610205825",
        ],
    },
    Reference {
        t: "12.967548226582466309395150081692",
        surface: 0,
        after: &[
            "-0.140054258804942818454735802038",
            "-0.00161644706687667860002852653796",
            "45.9475917330724148141090448397",
            "3.25898938095540853048816686963",
        ],
    },
    Reference {
        t: "14.698801697928282885118293598117",
        surface: 1,
        after: &[
            "-0.102762017183552202991836314057",
            "0.128900571884785819252535360696",
            "28.6610858679454954508721244434",
            "5.6091656766918925477073874141",
        ],
    },
    Reference {
        t: "15.101357615758903417842797680969",
        surface: 0,
        after: &[
            "-0.116240490848238985092665176017",
            "0.105775570231458032920864071792",
            "32.5150994827840492899406929523",
            "2.76018049266836321439944570971",
        ],
    },
    Reference {
        t: "16.469092933690447681404931845009",
        surface: 1,
        after: &[
            "-0.04038388295562448684735469207",
            "0.181876920923274366256713755097",
            "18.8706015796228219939332273413",
            "5.097022329453942908300068874",
        ],
    },
    Reference {
        t: "18.065267518231288602868465160889",
        surface: 0,
        after: &[
            "0.0927657057526950415393640594034",
            "0.142189104561288530248975793948",
            "34.8160878791412954520745974199",
            "6.88997898365978196455923850375",
        ],
    },
    Reference {
        t: "18.399507284668501285614221055413",
        surface: 1,
        after: &[
            "0.0776312044806553358453256214988",
            "0.158020596753168925562186461196",
            "31.6795096230400569177437120895",
            "4.06058636513231939941650336478",
        ],
    },
    Reference {
        t: "20.87348517903287025295132566641",
        surface: 0,
        after: &[
            "0.135744408447182564126154137214",
            "-0.047224100291014135419350763001",
            "56.4085146100343543383432418066",
            "5.91602967234308320984032962371",
        ],
    },
    Reference {
        t: "21.033621552080152690440134798418",
        surface: 1,
        after: &[
            "0.137131918282817918114277396887",
            "-0.0391938140618479987597460087392",
            "55.2663219541689222183057381044",
            "3.16655769552928489332266138656",
        ],
    },
    Reference {
        t: "23.251477935755318872727421366824",
        surface: 0,
        after: &[
            "0.0111210280558698903669179336692",
            "-0.1894036321557765812978865812",
            "77.4348196568909036966925580807",
            "4.8621921694703202511521627577",
        ],
    },
    Reference {
        t: "23.767117735750162726629874597097",
        surface: 1,
        after: &[
            "-0.0251604533873143190677178043096",
            "-0.186896238017181498481573390046",
            "72.3977945253887990252680735105",
            "7.56617891630624414649988352508",
        ],
    },
];

/// `chaplygin_sleigh_trajectories.json`, the first elastic billiard.
const SLEIGH: [Reference; 20] = [
    Reference {
        t: "1.009470559218937068172604429",
        surface: 0,
        after: &[
            "0.756629895651280423065586878",
            "0.6884013535098720696761255873",
            "0.9581174331832361599236410557",
        ],
    },
    Reference {
        t: "2.479298090213280124797755153",
        surface: 1,
        after: &[
            "0.07700962905849279236826624651",
            "-0.7575051159840131392525346867",
            "1.324615304386416358676543125",
        ],
    },
    Reference {
        t: "3.838623374396694704574244544",
        surface: 0,
        after: &[
            "0.3034764090931863988680448994",
            "0.7376744263763410680510526523",
            "1.507337478529750097689080883",
        ],
    },
    Reference {
        t: "5.163939242993815550432691131",
        surface: 1,
        after: &[
            "0.3443203377485740222049505901",
            "-0.7341931821688216015367295643",
            "1.698950040896328816264303963",
        ],
    },
    Reference {
        t: "6.556404482534240392441226939",
        surface: 0,
        after: &[
            "-0.02890693972047519088758232331",
            "0.7634448478010385663505025373",
            "1.919933340097141295084873053",
        ],
    },
    Reference {
        t: "8.25452618741307335308907856",
        surface: 1,
        after: &[
            "1.030132175139582259044210834",
            "-0.646324387321273855205316467",
            "2.551405532105761212035003888",
        ],
    },
    Reference {
        t: "10.17009666614681319165496766",
        surface: 0,
        after: &[
            "-0.6059048794121074804844435873",
            "-0.7671978480232211932812035974",
            "3.773331499283475868357674367",
        ],
    },
    Reference {
        t: "12.06154790047527823479501158",
        surface: 1,
        after: &[
            "0.9661259500163904219466084007",
            "0.6377759844321971258492996242",
            "3.982837027157004533570110307",
        ],
    },
    Reference {
        t: "13.88147588656568898401003872",
        surface: 0,
        after: &[
            "-0.4985927310090921545780315837",
            "-0.7769651525602470432444629248",
            "3.845432805908413226219821379",
        ],
    },
    Reference {
        t: "15.96833381786449201816693979",
        surface: 1,
        after: &[
            "1.336015600114100726633674551",
            "-0.505677911214301803137074632",
            "2.619898487892105785366401999",
        ],
    },
    Reference {
        t: "17.59937213331294855143481069",
        surface: 0,
        after: &[
            "0.2374124966746725420617394265",
            "0.7687587812029518416024053771",
            "1.984630921782489596863405973",
        ],
    },
    Reference {
        t: "18.96968062044274594318067888",
        surface: 1,
        after: &[
            "0.7726539849501368582458256373",
            "-0.6670645836768886740719906227",
            "1.864676379907186416183716971",
        ],
    },
    Reference {
        t: "20.26742310694919099163979943",
        surface: 0,
        after: &[
            "0.4062117921769193309086887911",
            "0.7403726016695936307764765318",
            "1.789824577194644122136745996",
        ],
    },
    Reference {
        t: "21.58050306256715834561925052",
        surface: 1,
        after: &[
            "0.8467234842788355732067503697",
            "-0.6514126515178394065367763814",
            "1.973578271169923328362779437",
        ],
    },
    Reference {
        t: "23.15299974694030421480506221",
        surface: 0,
        after: &[
            "-0.08515927531229211890629647165",
            "0.8039233434335938515639778488",
            "2.28895362521413238975807186",
        ],
    },
    Reference {
        t: "25.13813125067661920313383511",
        surface: 1,
        after: &[
            "1.509244867337563948347821045",
            "0.3875855574823970307278075505",
            "3.604583870081412532116531333",
        ],
    },
    Reference {
        t: "26.64278657904309033544577757",
        surface: 0,
        after: &[
            "0.5956396233260530790671516422",
            "-0.7280414057525933687512604753",
            "4.398413856041173186762203012",
        ],
    },
    Reference {
        t: "27.93346975214733302471998421",
        surface: 1,
        after: &[
            "0.8275438162689480472535243598",
            "0.660255713289966032008372359",
            "4.710181216353719562567610413",
        ],
    },
    Reference {
        t: "29.12673920427488799923287894",
        surface: 0,
        after: &[
            "1.096021436127054326344398677",
            "-0.5723712836981543924036522926",
            "5.124724224231706776080728864",
        ],
    },
    Reference {
        t: "31.2125169472522206237858096",
        surface: 1,
        after: &[
            "-0.4245567030327652146871416176",
            "0.8718434617288579525377303773",
            "5.993506203829974182941223582",
        ],
    },
];

/// `walker_orbits.json`, the first transient.
const WALKER: [Reference; 12] = [
    Reference {
        t: "1.4615880908781681015670946",
        surface: 0,
        after: &[
            "0.4",
            "-0.91804343979641592372844081",
            "1.0108128700888834992108362",
        ],
    },
    Reference {
        t: "2.9809413619273958187997353",
        surface: 0,
        after: &[
            "0.4",
            "-0.91001758763118506476666282",
            "1.001703304065422633771803",
        ],
    },
    Reference {
        t: "4.5125799407982354049468417",
        surface: 0,
        after: &[
            "0.4",
            "-0.9062099549657618270200752",
            "0.99673761781016197502163872",
        ],
    },
    Reference {
        t: "6.0505607944725587814477037",
        surface: 0,
        after: &[
            "0.4",
            "-0.90422257725872343776779906",
            "0.99413948674128453024768871",
        ],
    },
    Reference {
        t: "7.5918767500040360266324245",
        surface: 0,
        after: &[
            "0.4",
            "-0.9031856158076771698535051",
            "0.99278362561780740897172166",
        ],
    },
    Reference {
        t: "9.1349386363056492505358034",
        surface: 0,
        after: &[
            "0.4",
            "-0.90264509004169524864472772",
            "0.99207682084389070353256982",
        ],
    },
    Reference {
        t: "10.678912170007205292966867",
        surface: 0,
        after: &[
            "0.4",
            "-0.9023634847889446571537794",
            "0.99170857351423634321494635",
        ],
    },
    Reference {
        t: "12.223361083057360389053248",
        surface: 0,
        after: &[
            "0.4",
            "-0.90221681345962358375887078",
            "0.99151677188024525606965691",
        ],
    },
    Reference {
        t: "13.76805770838961753671574",
        surface: 0,
        after: &[
            "0.4",
            "-0.90214043213311233130844195",
            "0.99141688727629512857934226",
        ],
    },
    Reference {
        t: "15.312883365037651506585449",
        surface: 0,
        after: &[
            "0.4",
            "-0.90210065837822540174799115",
            "0.99136487448300092203182148",
        ],
    },
    Reference {
        t: "16.85777622017788879720064",
        surface: 0,
        after: &[
            "0.4",
            "-0.90207994795265323501907276",
            "0.99133779104653203714483088",
        ],
    },
    Reference {
        t: "18.402704068271886222164465",
        surface: 0,
        after: &[
            "0.4",
            "-0.90206916413296898640158337",
            "0.99132368881088342808354645",
        ],
    },
];

/// The doubles on both sides of a decimal number.
fn about(digits: &str) -> Interval {
    let nearest: f64 = digits.parse().unwrap();
    Interval::new(nearest.next_down(), nearest.next_up())
}

fn point(value: f64) -> Interval {
    Interval::point(value)
}

fn digits(number: &str) -> Extended<3> {
    number.parse().unwrap()
}

/// True if a number of many digits lies between the ends of an interval.
fn holds(range: Interval, number: Extended<3>) -> bool {
    let [lo, hi] = [range.lo, range.hi].map(Extended::<3>::from);
    (number - lo).nearest() >= 0.0 && (hi - number).nearest() >= 0.0
}

/// An impact of a reference: time, surface, and components of the state after it.
struct Reference {
    t: &'static str,
    surface: usize,
    after: &'static [&'static str],
}

/// Follows a run along a reference. Returns the width of the widest enclosure of a time or of a component.
fn follow<S: Variational + Impacting>(
    mut run: CertifiedRun<'_, S>,
    references: &[Reference],
    name: &str,
) -> f64 {
    let begun = Instant::now();
    let (mut count, mut widest) = (0, 0.0_f64);
    let ended = run.run(1e3, |impact| {
        let reference = &references[count];
        count += 1;
        assert_eq!(impact.surface, reference.surface, "{name}: impact {count}");
        let after = (0..)
            .zip(reference.after)
            .map(|(i, value)| (impact.after(i), *value));
        for (range, value) in core::iter::once((impact.time, reference.t)).chain(after) {
            assert!(
                holds(range, digits(value)),
                "{name}: impact {count}: {value} is not in {range:?}"
            );
            widest = widest.max(range.width());
        }
        match count == references.len() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    let (steps, time) = (run.steps(), begun.elapsed());
    println!("{name}: width {widest:.1e} after {count} impacts and {steps} steps in {time:.1?}");
    assert_eq!(count, references.len(), "{name}: {ended:?}");
    widest
}

fn state<S: System>(system: &S, q: &[f64], qdot: &[f64]) -> S::State {
    let vector = |values: &[f64]| {
        let mut vector = S::Vector::zeros(S::Vector::CAPACITY);
        vector.as_mut_slice()[..values.len()].copy_from_slice(values);
        vector
    };
    system
        .state_unchecked(0.0, &vector(q), &vector(qdot))
        .unwrap()
}

/// Impacts in numbers of 48 digits.
fn impacts<S: Variational + Scene>(system: &S, start: &S::State, t_end: f64) -> Vec<Impact<S, 3>> {
    let mut impacts = Vec::new();
    let simulation = ExtendedSimulation::new(system, system.effects());
    let run = simulation.run(At::<S, 3>::of(0.0, start), t_end, |impact| {
        impacts.push(*impact);
        ControlFlow::Continue(())
    });
    assert!(run.unwrap().outcome.is_ok_and(|outcome| outcome.is_done()));
    impacts
}

/// Follows a start beside a run in numbers of 48 digits. Returns the width of the widest component at the end.
fn beside<S: Variational + Scene + Impacting>(
    system: &S,
    start: &S::State,
    t_end: f64,
    name: &str,
) -> f64 {
    let exact = impacts(system, start, t_end);
    let begun = Instant::now();
    let mut run = CertifiedRun::new(system, 0.0, |i| point(start.as_slice()[i]));
    let mut count = 0;
    let mut late = 0.0_f64;
    let ended = run.run(t_end, |impact| {
        let exact = &exact[count];
        count += 1;
        assert_eq!(impact.surface, exact.surface, "{name}: impact {count}");
        assert!(
            holds(impact.time, exact.t),
            "{name}: impact {count} in {:?}",
            impact.time
        );
        late = late.max(impact.time.width());
        for i in 0..S::State::CAPACITY {
            let ranges = [impact.before(i), impact.after(i)];
            let values = [exact.before, exact.after].map(|row| row.as_slice()[i]);
            assert!(
                ranges
                    .into_iter()
                    .zip(values)
                    .all(|(range, value)| holds(range, value)),
                "{name}: impact {count}: component {i}"
            );
        }
        ControlFlow::Continue(())
    });
    assert!(
        ended.is_ok() && count == exact.len(),
        "{name}: {count} impacts of {}, {ended:?}",
        exact.len()
    );
    let (width, steps, time) = (run.width(), run.steps(), begun.elapsed());
    println!(
        "{name}: width {width:.1e}, of times {late:.1e}, after {count} impacts and {steps} steps in {time:.1?}"
    );
    width
}

/// `sqrt(2/g) (1 + 2 (e + .. + e^(n-1)))`, when a ball from the height 1 bounces.
fn bounces(g: f64, e: f64, count: usize) -> Vec<Extended<3>> {
    let [fall, e] = [Extended::from(2.0) / Extended::from(g), Extended::from(e)];
    let fall = Numbers::sqrt(fall);
    let (mut flight, mut t) = (fall, Extended::from(0.0));
    let mut times = Vec::new();
    for _ in 0..count {
        t = t + flight;
        times.push(t);
        flight = match times.len() {
            1 => Extended::from(2.0) * e * fall,
            _ => e * flight,
        };
    }
    times
}

#[test]
fn a_ball_is_held_to_its_hundredth_bounce() {
    let ball = Ball { g: 9.81, e: 0.9 };
    let exact = bounces(ball.g, ball.e, 100);
    let begun = Instant::now();
    let mut run = CertifiedRun::new(&ball, 0.0, |i| point([1.0, 0.0][i]));
    let (mut count, mut width) = (0, 0.0);
    let ended = run.run(20.0, |impact| {
        assert!(
            holds(impact.time, exact[count]),
            "{count}: {:?}",
            impact.time
        );
        (count, width) = (count + 1, impact.time.width());
        match count {
            100 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    println!(
        "ball: width {width:.1e} after {count} impacts and {} steps in {:.1?}",
        run.steps(),
        begun.elapsed()
    );
    assert!(
        count == 100 && width < 1e-11,
        "{count}, {width:e}, {ended:?}"
    );
}

#[test]
fn bounces_lie_in_their_enclosures() {
    let ball = Ball::default();
    let run = CertifiedRun::new(&ball, 0.0, |i| point([1.0, 0.0][i]));
    assert!(follow(run, &BOUNCES, "ball of 3/4") < 1e-12);
}

#[test]
fn a_ball_that_starts_at_the_floor_leaves_it() {
    let ball = Ball::default();
    assert!(beside(&ball, &state(&ball, &[0.0], &[1.0]), 5.0, "thrown ball") < 1e-12);
}

#[test]
fn a_rolling_disk_is_held_over_twenty_impacts() {
    let disk = RollingDisk::default();
    let start = [
        point(0.0),
        point(0.0),
        point(0.0),
        Interval::pi() * point(0.5),
        point(10.0),
        about("0.2"),
    ];
    let ranges = ["0.0025", "0.01", "1.25e-7", "6.25e-8", "0.15", "0.2"];
    let mut run = CertifiedRun::new(&disk, 0.0, |i| start[i]);
    for (i, range) in ranges.into_iter().enumerate() {
        run = run.with_parameter(i, about(range));
    }
    assert!(follow(run, &DISK, "disk") < 1e-4);
}

#[test]
fn a_disk_lies_beside_a_run_of_48_digits() {
    let disk = RollingDisk::default();
    let phi = core::f64::consts::FRAC_PI_2;
    let start = state(&disk, &[0.0, 0.0, 0.0, phi], &[0.0, 0.1, 10.0, 0.2]);
    assert!(beside(&disk, &start, 23.9, "disk of doubles") < 1e-4);
}

#[test]
fn a_sleigh_is_held_over_twenty_impacts() {
    let sleigh = Sleigh::default();
    let start = [0.0, 0.0, 0.5, 1.0, 0.5];
    let run = CertifiedRun::new(&sleigh, 0.0, |i| point(start[i])).with_parameter(2, about("0.2"));
    assert!(follow(run, &SLEIGH, "sleigh") < 1e-6);
}

#[test]
fn a_walker_is_held_over_twelve_steps() {
    let walker = Walker::default();
    let start = ["0.4", "-1.0148146300837202625", "0.9913083699240868"];
    let mut run = CertifiedRun::new(&walker, 0.0, |i| about(start[i]));
    for i in [2, 3] {
        run = run.with_parameter(i, about("0.4"));
    }
    assert!(follow(run, &WALKER, "walker") < 1e-11);
}

#[test]
fn a_walker_on_springs_is_held_over_five_steps() {
    let walker = SpringWalker::default();
    let start = state(&walker, &[0.0, 0.97], &[0.351, 0.0]);
    assert!(beside(&walker, &start, 8.0, "walker on springs") < 1e-9);
}

#[test]
fn a_wall_that_moves_is_met_in_its_enclosure() {
    let swing = Swing::default();
    assert!(beside(&swing, &state(&swing, &[0.5], &[1.3]), 20.0, "swing") < 1e-11);
}

#[test]
fn every_motion_from_a_box_is_held_across_impacts() {
    const RADIUS: f64 = 1e-9;
    let disk = RollingDisk::default();
    let centre = [0.01, -0.02, 0.0, 1.5, 10.0, 0.2];
    let mut run = CertifiedRun::new(&disk, 0.0, |i| point(centre[i]).widened(RADIUS));
    let mut enclosures = Vec::new();
    run.run(7.3, |impact| {
        enclosures.push((
            impact.time,
            core::array::from_fn::<_, 6, _>(|i| impact.after(i)),
        ));
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(enclosures.len() >= 3);
    let mut reached = [Interval::new(f64::INFINITY, f64::NEG_INFINITY); 6];
    for corner in 0..64 {
        let start = core::array::from_fn::<_, 6, _>(|i| {
            centre[i]
                + if corner >> i & 1 == 0 {
                    -RADIUS
                } else {
                    RADIUS
                }
        });
        let exact = impacts(&disk, &start.into(), 7.3);
        assert_eq!(exact.len(), enclosures.len());
        for (exact, (time, after)) in exact.iter().zip(&enclosures) {
            assert!(holds(*time, exact.t), "{corner}: {time:?}");
            for i in 0..6 {
                assert!(
                    holds(after[i], exact.after[i]),
                    "{corner}, {i}: {:?}",
                    after[i]
                );
            }
        }
        for (range, value) in reached.iter_mut().zip(exact.last().unwrap().after) {
            *range = range.hull(point(value.nearest()));
        }
    }
    // The widest box is nearly as wide as the motions require.
    let found = enclosures.last().unwrap().1;
    let [found, reached] = [found, reached].map(|ranges| {
        let widths = ranges.map(Interval::width);
        widths.into_iter().fold(0.0, f64::max)
    });
    println!("box of {RADIUS}: width {found:.1e}, of its corners {reached:.1e}");
    assert!(found < 1.1 * reached, "{found:e}, {reached:e}");
}

#[test]
fn every_parameter_of_a_range_is_held() {
    let ball = Ball::default();
    let [g, e] = [Interval::new(0.999, 1.001), Interval::new(0.749, 0.751)];
    let mut run = CertifiedRun::new(&ball, 0.0, |i| point([1.0, 0.0][i]))
        .with_parameter(0, g)
        .with_parameter(1, e);
    let mut times = Vec::new();
    run.run(5.0, |impact| {
        times.push(impact.time);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(times.len(), 2);
    println!("times {times:?}");
    for (g, e) in [
        (g.lo, e.lo),
        (g.lo, e.hi),
        (g.hi, e.lo),
        (g.hi, e.hi),
        (1.0, 0.75),
    ] {
        let ball = Ball { g, e };
        let exact = impacts(&ball, &state(&ball, &[1.0], &[0.0]), 5.0);
        for (time, exact) in times.iter().zip(exact) {
            assert!(holds(*time, exact.t), "{g}, {e}: {time:?}");
        }
    }
    assert!(times[1].width() < 0.05, "{times:?}");
}
