use super::*;
use crate::fixture;
use isostudy_design::config::SweepSection;

fn swept() -> Study {
    let mut study = fixture::study();
    let section: SweepSection = toml::from_str(
        r#"
        cells = [8, 16]
        objects = ["ss"]
        settings = [
            { methods = ["bi"], key = "edge_clamp", values = [0, 0.25] },
            { methods = ["bi"], key = "refine_crossings", values = [false, true] },
            { methods = ["su"], key = "placement", values = ["projected"] },
            { objects = ["ss"], key = "field.radius", values = [1, 2] },
        ]"#,
    )
    .unwrap();
    study.file.sweep = Some(section);
    study
}

/// The cases of `bi` on the sphere, of which these have no mesh.
fn meshes<'s>(sweep: &'s Sweep<'s>, study: &Study, left_out: &[u64]) -> Vec<CaseMesh<'s>> {
    let pair = sweep.pairs.iter().find(|pair| pair.configuration.id.to_string() == "ss_bi").unwrap();
    let records = fixture::meshes(study);
    let record = records.iter().find(|record| record.id == pair.configuration.id).unwrap();
    let of = |number: u64| {
        let mut record = record.clone();
        record.counts.triangles = 100 + number;
        let made = if left_out.contains(&number) { Err("no surface, \"at all\"".into()) } else { Ok(record) };
        CaseMesh { case: sweep.case(pair, number), made }
    };
    (0..pair.cases).map(of).collect()
}

#[test]
fn what_is_written_is_read_again() {
    let study = swept();
    let sweep = study.sweep().unwrap();
    let cases = meshes(&sweep, &study, &[3]);
    assert_eq!(cases.len(), 16);
    let frame = case_meshes(&study, &sweep, &cases);
    let dtypes: Vec<(String, DataType)> =
        frame.frame.columns()[..7].iter().map(|of| (of.name().to_string(), of.dtype().clone())).collect();
    let want = [
        ("case", DataType::Int64),
        ("cells_per_axis", DataType::Int64),
        ("method.edge_clamp", DataType::Float64),
        ("method.refine_crossings", DataType::Boolean),
        ("method.placement", DataType::String),
        ("object.field.radius", DataType::Int64),
        ("left_out", DataType::String),
    ];
    assert_eq!(dtypes, want.map(|(name, dtype)| (name.to_owned(), dtype)));
    let bytes = frame.to_parquet().unwrap();
    let read = measured_cases(bytes.clone(), false).unwrap();
    for (case, (number, measures)) in cases.iter().zip(&read) {
        assert_eq!(case.case.number, *number);
        let triangles = measures.as_ref().map(|of| of[1]);
        let want = (*number != 3).then_some((CaseQuantity::Triangles, Some(100.0 + *number as f64)));
        assert_eq!(triangles, want);
    }
    assert_eq!(timed_cases(bytes).unwrap_err().to_string(), "not read as Parquet: it has no column machine");
    // A setting of another method is missing, and so is everything of a case without a mesh.
    let placement = frame.frame.column("method.placement").unwrap();
    assert_eq!(placement.null_count(), 16);
    assert_eq!(frame.frame.column("left_out").unwrap().null_count(), 15);
    assert_eq!(frame.frame.column("radius_ratio_mean").unwrap().null_count(), 1);
}

#[test]
fn all_files_have_the_same_columns() {
    let mut study = swept();
    study.file.objects[1].region =
        Some(isostudy_design::config::RegionSection { name: "ground".into(), min: [0.0; 3], max: [1.0; 3] });
    let sweep = study.sweep().unwrap();
    let names = |left_out: &[u64]| -> Vec<(String, DataType)> {
        let frame = case_meshes(&study, &sweep, &meshes(&sweep, &study, left_out)).frame;
        frame.columns().iter().map(|of| (of.name().to_string(), of.dtype().clone())).collect()
    };
    let all: Vec<u64> = (0..16).collect();
    assert_eq!(names(&[]), names(&all));
    assert!(names(&all).iter().any(|(name, _)| name == "region_distance_mean"));
}

#[test]
fn times_have_their_machine() {
    let study = swept();
    let sweep = study.sweep().unwrap();
    let mut run = fixture::bench(&study);
    let id = run.samples[0].id.clone();
    run.samples.retain(|sample| sample.id == id);
    run.machine.model = Some("Example, \"fast\" CPU".into());
    let cases: Vec<CaseTimes<'_>> = (0..2)
        .map(|number| CaseTimes {
            case: sweep.case(&sweep.pairs[0], number),
            made: if number == 0 { Ok(run.clone()) } else { Err("crashed".into()) },
        })
        .collect();
    let read = timed_cases(case_times(&sweep, &cases).to_parquet().unwrap()).unwrap();
    let seconds = median(run.samples.iter().map(|sample| sample.total_s).collect(), LEVEL).unwrap().median;
    assert_eq!(read[0], (0, Some((machine_name(&run), seconds))));
    assert_eq!(read[1], (1, None));
}
