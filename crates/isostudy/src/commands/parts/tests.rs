use super::*;
use serde_json::json;
use std::fs;
use tempfile::TempDir;

const SIMULATION: Simulation<'static> = Simulation { command: "analyse --self-test", study: None };

/// Two series of ten and of three studies.
fn blank() -> Vec<Series> {
    let series =
        |name: &str, all, things| Series { name: name.into(), all, studies: 0..all, counts: vec![0; things] };
    vec![series("a", 10, 2), series("b", 3, 1)]
}

/// A part of them in which everything happened in every study.
fn counted(part: Part) -> Vec<Series> {
    let count = |of: Series| {
        let studies = part.studies(of.all);
        let counts = vec![studies.end - studies.start; of.counts.len()];
        Series { studies, counts, ..of }
    };
    blank().into_iter().map(count).collect()
}

/// Three parts, as files.
fn files(folder: &TempDir) -> Vec<PathBuf> {
    let file = |number| {
        let path = folder.path().join(format!("{number}.json"));
        let part = Part::new(number, 3).unwrap();
        SIMULATION.write(&path, &json!({"seed": 1, "share": 0.6}), part, &counted(part)).unwrap();
        path
    };
    (1..=3).map(file).collect()
}

fn merged(paths: &[PathBuf]) -> Result<Vec<Series>> {
    SIMULATION.read(paths)?.whole(blank())
}

/// What is said of files that are refused.
fn refused(paths: &[PathBuf]) -> String {
    format!("{:#}", merged(paths).unwrap_err())
}

/// Changes the contents of a file, and gives it their digest.
fn forge(path: &Path, change: impl FnOnce(&mut Contents)) {
    let mut contents = contents(path).unwrap();
    change(&mut contents);
    let sha256 = sha256(&serde_json::to_vec(&contents).unwrap());
    fs::write(path, serde_json::to_vec(&File { schema: SCHEMA, sha256, contents }).unwrap()).unwrap();
}

#[test]
fn parts_are_typed_as_a_number_and_how_many() {
    assert_eq!(part("3/100"), Ok(Part::new(3, 100).unwrap()));
    assert_eq!(part("1/1"), Ok(Part::WHOLE));
    for wrong in ["", "3", "/", "3/", "0/3", "4/3", "-1/3", "1/10001", "a/b", "1/2/3", "1.5/3"] {
        assert!(part(wrong).unwrap_err().contains("3/100"), "{wrong}");
    }
}

#[test]
fn files_in_any_order_are_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, c]: [PathBuf; 3] = files(&folder).try_into().unwrap();
    let whole = counted(Part::WHOLE);
    for order in [[&a, &b, &c], [&c, &a, &b], [&b, &c, &a]] {
        assert_eq!(merged(&order.map(Clone::clone)).unwrap(), whole);
    }
    // The same number to the last bit.
    SIMULATION.write(&a, &json!({"share": 0.1 + 0.2}), Part::WHOLE, &whole).unwrap();
    let arguments: Map<String, Value> =
        SIMULATION.read(&[a]).unwrap().arguments(|_: &Map<String, Value>| Ok(())).unwrap();
    assert_eq!(arguments["share"].as_f64().map(f64::to_bits), Some((0.1_f64 + 0.2).to_bits()));
}

#[test]
fn what_is_no_whole_is_refused_and_the_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let all = files(&folder);
    let [a, b, c]: [PathBuf; 3] = all.clone().try_into().unwrap();
    let name = |path: &PathBuf| path.display().to_string();
    let missing = refused(&[a.clone(), c.clone()]);
    assert!(missing.starts_with(&name(&a)) && missing.ends_with("missing: 2"), "{missing}");
    let twice = refused(&[a.clone(), b.clone(), b.clone(), c.clone()]);
    assert_eq!(twice, format!("{}: part 2 of 3 is given twice", name(&b)));
    let copy = folder.path().join("copy.json");
    fs::copy(&b, &copy).unwrap();
    let copied = refused(&[a.clone(), b.clone(), copy.clone(), c.clone()]);
    assert_eq!(copied, format!("{}: is part 2 of 3, and so is {}", name(&copy), name(&b)));
    // What a part says of itself; the digest is right.
    type Change = fn(&mut Contents);
    let changes: [(Change, &str); 9] = [
        (|of| of.command = "design power".into(), "`isostudy design power`"),
        (|of| of.version = "9.9.9".into(), "9.9.9"),
        (|of| of.sources = "0".into(), "other sources"),
        (|of| drop(of.arguments.insert("seed".into(), 2.into())), "seed is 2, and 1 in "),
        (|of| drop(of.arguments.remove("seed")), "seed is not there, and 1 in "),
        (|of| of.parts = 4, "is part 2 of 4, and "),
        (|of| of.part = 4, "no part 4 of 3"),
        (|of| of.series[0].studies = 11, "does not hold what part 2 of 3 counts"),
        (|of| of.series[0].counts[0] = 4, "does not hold what part 2 of 3 counts"),
    ];
    for (change, said) in changes {
        forge(&b, change);
        let refused = refused(&all);
        assert!(refused.starts_with(&name(&b)) && refused.contains(said), "{said}: {refused}");
        files(&folder);
    }
    assert_eq!(merged(&all).unwrap(), counted(Part::WHOLE));
}

/// Any byte of a file that is another one, and any end that is missing, is noticed; or nothing but blanks has changed.
#[test]
fn a_damaged_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let all = files(&folder);
    let whole = merged(&all).unwrap();
    let bytes = fs::read(&all[1]).unwrap();
    let name = all[1].display().to_string();
    let is_refused = |damaged: &[u8], place: usize| {
        fs::write(&all[1], damaged).unwrap();
        match merged(&all) {
            Err(error) => assert!(format!("{error:#}").starts_with(&name), "{place}: {error:#}"),
            Ok(found) => panic!("{place}: {found:?} of {}", String::from_utf8_lossy(damaged)),
        }
    };
    for place in 0..bytes.len() - 1 {
        let mut damaged = bytes.clone();
        // A digit becomes another one.
        damaged[place] ^= 1;
        is_refused(&damaged, place);
        is_refused(&bytes[..place], place);
    }
    // A longer file, an unknown key, and another schema.
    let text = String::from_utf8(bytes.clone()).unwrap();
    is_refused(format!("{text}{{}}").as_bytes(), 0);
    is_refused(text.replacen("\"command\"", "\"more\":0,\"command\"", 1).as_bytes(), 0);
    fs::write(&all[1], text.replacen("\"schema\":1", "\"schema\":2", 1)).unwrap();
    assert!(refused(&all).contains("schema = 2: this version reads 1"), "{}", refused(&all));
    fs::write(&all[1], bytes).unwrap();
    assert_eq!(merged(&all).unwrap(), whole);
}
