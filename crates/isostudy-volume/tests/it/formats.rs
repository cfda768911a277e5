//! Every format, type, byte order and encoding reads alike; what is refused, and where.

use crate::files::*;
use isostudy_volume::{Problem, Volume};

#[test]
fn nrrd_attached_and_detached() {
    let folder = Folder::new();
    for kind in TYPES {
        for encoding in ["raw", "gzip", "hex", "text"] {
            for big_endian in [false, true] {
                let header = nrrd_header(kind, encoding, big_endian);
                let data = encoded(&bytes(kind, big_endian), encoding, kind);
                folder.write("a.nrrd", [header.as_bytes(), b"\n", &data].concat());
                folder.write("b.nhdr", format!("{header}data file: b.data\n"));
                folder.write("b.data", &data);
                // Lines before, whatever the encoding.
                folder.write(
                    "c.nhdr",
                    format!("{header}line skip: 2\ndata file: c.data\n").replace('\n', "\r\n"),
                );
                folder.write("c.data", [&b"one\ntwo\n"[..], &data].concat());
                for name in ["a.nrrd", "b.nhdr", "c.nhdr"] {
                    let got = folder.read(name).unwrap();
                    assert_eq!(got, wanted(kind), "{name} {kind} {encoding} {big_endian}");
                }
            }
        }
    }
}

#[test]
fn metaimage_local_and_apart() {
    let folder = Folder::new();
    for kind in TYPES {
        for encoding in ["raw", "zlib", "text"] {
            for big_endian in [false, true] {
                let header = meta_header(kind, encoding, big_endian);
                let data = encoded(&bytes(kind, big_endian), encoding, kind);
                folder.write("a.mha", [header.as_bytes(), b"ElementDataFile = LOCAL\n", &data].concat());
                folder.write("b.mhd", format!("{header}ElementDataFile = b.data\n"));
                folder.write("b.data", &data);
                for name in ["a.mha", "b.mhd"] {
                    let got = folder.read(name).unwrap();
                    assert_eq!(got, wanted(kind), "{name} {kind} {encoding} {big_endian}");
                }
            }
        }
    }
}

#[test]
fn raw_with_a_toml_header() {
    let folder = Folder::new();
    let want = |kind| Volume { steps: [[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, -3.0]], ..wanted(kind) };
    for kind in TYPES {
        for encoding in ["raw", "gzip"] {
            for (endian, big_endian) in [("little", false), ("big", true)] {
                let header = format!(
                    "size = [4, 3, 2]\ntype = '{kind}'\nencoding = '{encoding}'\nendian = '{endian}'\nskip_bytes = 3\n\
                     spacing = [2, 0.5, -3]\norigin = [1, -2, 3]\n"
                );
                let data = encoded(&[&b"abc"[..], &bytes(kind, big_endian)].concat(), encoding, kind);
                folder.write("a.toml", &header);
                folder.write("a.raw", &data);
                folder.write("b.toml", format!("{header}file = 'elsewhere.bin'\n"));
                folder.write("elsewhere.bin", &data);
                for name in ["a.toml", "a.raw", "b.toml"] {
                    assert_eq!(folder.read(name).unwrap(), want(kind), "{name} {kind} {encoding} {endian}");
                }
            }
        }
    }
}

#[test]
fn the_rest_of_a_header_says_where_samples_lie() {
    let folder = Folder::new();
    let data = bytes("u8", false);
    let read = |lines: &str| {
        let header = format!("NRRD0005\ntype: uchar\nencoding: raw\n{}\n\n", lines.trim_end());
        folder.write("a.nrrd", [header.as_bytes(), &data].concat());
        folder.read("a.nrrd").map(|v| (v.origin, [v.steps[0][0], v.steps[1][1], v.steps[2][2]]))
    };
    let sizes = "dimension: 3\nsizes: 4 3 2";
    for (lines, origin, spacing) in [
        ("", [0.; 3], [1.; 3]),
        ("spacings: 1 2 nan", [0.; 3], [1., 2., 1.]),
        ("spacings: 1 2 3\naxis mins: 10 20 30", [10.5, 21., 31.5], [1., 2., 3.]),
        ("spacings: 1 2 3\naxis mins: 10 20 30\ncenters: node cell node", [10., 21., 30.], [1., 2., 3.]),
        ("axis mins: 0 0 0\naxis maxs: 6 6 6\ncenterings: node node node", [0.; 3], [2., 3., 6.]),
        ("axis mins: 0 0 0\naxis maxs: 4 6 6", [0.5, 1., 1.5], [1., 2., 3.]),
    ] {
        assert_eq!(read(&format!("{sizes}\n{lines}")).unwrap(), (origin, spacing), "{lines}");
    }
    // A fourth axis of one sample is none.
    let fourth =
        "dimension: 4\nsizes: 1 4 3 2\nspace dimension: 3\nspace directions: none (1,0,0) (0,1,0) (0,0,1)";
    assert_eq!(read(fourth).unwrap(), ([0.; 3], [1.; 3]));
    let thin = "dimension: 4\nsizes: 1 1 8 3\nspace directions: (9,0,0) none (0,1,0) (0,0,1)";
    assert_eq!(read(thin).unwrap(), ([0.; 3], [9., 1., 1.]));
}

#[test]
fn a_header_may_stand_before_the_data_of_another() {
    let folder = Folder::new();
    let (data, header) = (bytes("u16", true), nrrd_header("u16", "raw", true));
    folder.write("a.nhdr", format!("{header}byte skip: -1\ndata file: a.data\n"));
    folder.write(
        "a.mhd",
        format!("{}HeaderSize = -1\nElementDataFile = a.data\n", meta_header("u16", "raw", true)),
    );
    folder.write("a.data", [&b"some other header"[..], &data].concat());
    assert_eq!(folder.read("a.nhdr").unwrap(), wanted("u16"));
    assert_eq!(folder.read("a.mhd").unwrap(), wanted("u16"));
}

#[test]
fn errors_name_the_file_the_line_and_the_value() {
    let folder = Folder::new();
    folder.write("short.data", [0; 23]);
    folder.write("long.data", [0; 25]);
    let nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n";
    let meta = "NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n";
    for (name, header, want) in [
        (
            "a.txt",
            String::new(),
            "a.txt: known endings are .nrrd, .nhdr, .mha, .mhd, .toml and .raw (with a .toml beside it)",
        ),
        ("a.nrrd", "P5\n".into(), "a.nrrd: line 1: the file does not start with `NRRD`"),
        ("a.nrrd", "NRRD0009\n".into(), "a.nrrd: NRRD version `9` is not supported; 1 to 5 are"),
        (
            "a.nrrd",
            nrrd.replace("uchar", "block"),
            "a.nrrd: type `block` is not supported; 8- to 32-bit whole numbers, float and double are",
        ),
        (
            "a.nrrd",
            nrrd.replace("raw", "bzip2"),
            "a.nrrd: encoding `bzip2` is not supported; raw, gzip, text and hex are",
        ),
        ("a.nrrd", format!("{nrrd}sizes: 1 2 3\n"), "a.nrrd: line 6: a second field `sizes`"),
        ("a.nrrd", format!("{nrrd}spacing: 1 1 2\n"), "a.nrrd: line 6: `spacing` is no field of NRRD"),
        ("a.nrrd", format!("{nrrd}what is this\n"), "a.nrrd: line 6: `what is this` is not `field: value`"),
        ("a.nrrd", nrrd.replace("4 3 2", "4 x 2"), "a.nrrd: line 4: `x` is not a number here"),
        ("a.nrrd", nrrd.into(), "a.nrrd: the header has no `data file`"),
        ("a.nrrd", format!("{nrrd}\n"), "a.nrrd: the data ends after 0 of 24 samples"),
        (
            "a.nrrd",
            format!("{nrrd}\n0123456789012345678901234"),
            "a.nrrd: there is more data than the 24 samples that the header claims",
        ),
        (
            "a.nrrd",
            format!("{}\n", nrrd.replace("4 3 2", "4 0 2")),
            "a.nrrd: sizes [4, 0, 2]: every axis needs at least one sample",
        ),
        (
            "a.nrrd",
            format!("{}\n", nrrd.replace("4 3 2", "4 3 2 5").replace("n: 3", "n: 4")),
            "a.nrrd: sizes `[4, 3, 2, 5]` is not supported; three axes longer than 1 are",
        ),
        (
            "a.nrrd",
            format!("{}\n", nrrd.replace("4 3 2", "4 3")),
            "a.nrrd: sizes `2 values for 3 axes` is not supported; one an axis is",
        ),
        ("a.nrrd", format!("{}\n", nrrd.replace("uchar", "short")), "a.nrrd: the header has no `endian`"),
        (
            "a.nrrd",
            format!("{nrrd}spacings: 1 0 1\n\n"),
            "a.nrrd: the steps [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]] from sample to sample, from [0.0, 0.0, 0.0], span no space",
        ),
        (
            "a.nrrd",
            format!("{nrrd}space directions: (1,0,0) (2,0,0) (0,0,1)\n\n"),
            "a.nrrd: the steps [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]] from sample to sample, from [0.0, 0.0, 0.0], span no space",
        ),
        (
            "a.nrrd",
            format!("{nrrd}space directions: (1,0) (0,1,0) (0,0,1)\n\n"),
            "a.nrrd: line 6: `(1,0) (0,1,0) (0,0,1)` are not vectors `(x,y,z)` or `none`",
        ),
        (
            "a.nrrd",
            format!("{}\n1 2 300", nrrd.replace("raw", "text")),
            "a.nrrd: sample 2: `300` is not a number of the type u8",
        ),
        (
            "a.nrrd",
            format!("{}\n1 2 3", nrrd.replace("raw", "text")),
            "a.nrrd: the data ends after 3 of 24 samples",
        ),
        (
            "a.nhdr",
            format!("{nrrd}data file: nowhere.raw\n"),
            "nowhere.raw: No such file or directory (os error 2)",
        ),
        ("a.nhdr", format!("{nrrd}data file: .\n"), ".: not a file"),
        (
            "a.nhdr",
            format!("{nrrd}data file: short.data\n"),
            "short.data: the data ends after 23 of 24 samples",
        ),
        (
            "a.nhdr",
            format!("{nrrd}data file: slice%03d.raw 1 9 1\n"),
            "a.nhdr: data file `slice%03d.raw 1 9 1` is not supported; one file is",
        ),
        (
            "a.mhd",
            format!("{meta}ElementDataFile = long.data\n"),
            "long.data: there is more data than the 24 samples that the header claims",
        ),
        ("a.mha", meta.into(), "a.mha: the header has no `ElementDataFile`"),
        (
            "a.mha",
            format!("{meta}ElementNumberOfChannels = 3\n"),
            "a.mha: ElementNumberOfChannels `3` is not supported; 1 is",
        ),
        (
            "a.mha",
            format!("{meta}ElementToIntensityFunctionSlope = 2\n"),
            "a.mha: ElementToIntensityFunctionSlope `2` is not supported; 1 is",
        ),
        (
            "a.mha",
            format!("{meta}ElementToIntensityFunctionOffset = -1024\n"),
            "a.mha: ElementToIntensityFunctionOffset `-1024` is not supported; 0 is",
        ),
        (
            "a.mha",
            format!(
                "{meta}TransformMatrix = 0 1 0 -1 0 0 0 0 1\nCenterOfRotation = 0 0 5\nElementDataFile = LOCAL\n"
            ),
            "a.mha: CenterOfRotation `[0.0, 0.0, 5.0]` is not supported; 0 0 0 with turned axes is",
        ),
        ("a.mha", format!("{meta}CompressedData = maybe\n"), "a.mha: line 4: `maybe` is not True or False"),
        ("a.mha", format!("{meta}ElementSpacing = 1 1\n"), "a.mha: line 4: 2 numbers where 3 belong"),
        (
            "a.mha",
            format!("{}ElementDataFile = LOCAL\n", meta.replace("4 3 2", "4 3")),
            "a.mha: DimSize `[4, 3]` is not supported; three sizes are",
        ),
        (
            "a.mha",
            format!("{meta}CompressedData = True\nElementDataFile = LOCAL\nabc"),
            "a.mha: corrupt deflate stream",
        ),
        ("none.raw", String::new(), "none.toml: No such file or directory (os error 2)"),
    ] {
        folder.write(name, header);
        assert_eq!(folder.refusal(name), want);
    }
    folder.write("a.toml", "size = [1, 2, 3]\ntype = 'u8'\nspaces = 3\n");
    assert!(folder.refusal("a.toml").contains("unknown field `spaces`"), "{}", folder.refusal("a.toml"));
    assert!(matches!(*isostudy_volume::read(folder.as_path(), 1).unwrap_err().problem, Problem::Ending));
}

/// Each fact once, also for those who walk along the sources.
#[test]
fn errors_say_nothing_twice() {
    let folder = Folder::new();
    folder.write("bad.mha", "NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\nCompressedData = True\nElementDataFile = LOCAL\nabc");
    folder.write("bad.toml", "size = [1, 2, 3]\ntype = 'u8'\nspaces = 3\n");
    for (name, fact) in [
        ("none.nrrd", "No such file"),
        ("a.txt", "known endings"),
        ("bad.mha", "corrupt deflate stream"),
        ("bad.toml", "unknown field"),
    ] {
        let error = folder.read(name).unwrap_err();
        let mut chain = error.to_string();
        let mut source = std::error::Error::source(&error);
        while let Some(next) = source {
            chain.push_str(&format!(": {next}"));
            source = next.source();
        }
        assert_eq!((chain.matches(fact).count(), chain.matches(name).count()), (1, 1), "{chain}");
    }
}

/// As they stand in the headers that ITK writes.
#[test]
fn keys_that_change_nothing_are_passed_over() {
    let folder = Folder::new();
    let header = meta_header("u8", "raw", false)
        .replace("Offset", "CenterOfRotation = 0 0 0\nAnatomicalOrientation = RAI\nOffset");
    let slope = "ElementToIntensityFunctionSlope = 1.0\nElementToIntensityFunctionOffset = 0\n";
    let all = [format!("{header}{slope}ElementDataFile = LOCAL\n").into_bytes(), bytes("u8", false)].concat();
    folder.write("a.mha", all);
    assert_eq!(folder.read("a.mha").unwrap(), wanted("u8"));
    let straight = "NDims = 3\nDimSize = 1 2 1\nElementType = MET_UCHAR\nCenterOfRotation = 1 2 3\nElementDataFile = LOCAL\nab";
    folder.write("b.mha", straight);
    assert_eq!(folder.read("b.mha").unwrap().values, [97.0, 98.0]);
}

#[test]
fn doubles_beyond_single_precision_are_counted() {
    let folder = Folder::new();
    let header = |kind, encoding| {
        format!(
            "NRRD0004\ntype: {kind}\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: {encoding}\n\n"
        )
    };
    let numbers = [0.0, 1e300, f64::INFINITY, -1e39, f64::NAN, 3.4e38, f64::NEG_INFINITY, 1e-300];
    let data = numbers.map(f64::to_le_bytes).concat();
    folder.write("a.nrrd", [header("double", "raw").as_bytes(), &data].concat());
    for kind in ["double", "float"] {
        let name = format!("{kind}.nrrd");
        folder.write(&name, format!("{}0 1e300 inf -1e39 NaN 3.4e38 -infinity 1e-300", header(kind, "text")));
    }
    for name in ["a.nrrd", "double.nrrd", "float.nrrd"] {
        let want =
            format!("{name}: 2 of 8 samples are beyond 3.4028235e38, the largest number of single precision");
        assert_eq!(folder.refusal(name), want);
    }
    // Infinity itself is a value.
    folder.write("b.nrrd", format!("{}0 1 inf 2 NaN 3.4e38 -inf 1", header("double", "text")));
    assert_eq!(folder.read("b.nrrd").unwrap().values[2], f32::INFINITY);
}

#[test]
fn sizes_that_overflow_or_lie_take_no_memory() {
    let folder = Folder::new();
    for sizes in ["4294967296 4294967296 4294967296", "18446744073709551615 2 1", "100000000 1000 10"] {
        for encoding in ["raw", "gzip", "text", "hex"] {
            let header =
                format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {sizes}\nencoding: {encoding}\n\n");
            folder.write("a.nrrd", [header.as_bytes(), &encoded(b"abcdefgh", encoding, "u8")].concat());
            let problem = folder.read("a.nrrd").unwrap_err().problem;
            assert!(
                matches!(*problem, Problem::TooManySamples { .. } | Problem::Truncated { .. }),
                "{problem}"
            );
        }
    }
    // And a limit is a limit, before anything is read.
    folder.write("a.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 10 10\nencoding: raw\n\n");
    let problem = isostudy_volume::read(&folder.path("a.nrrd"), 3999).unwrap_err().problem;
    assert!(matches!(*problem, Problem::TooManySamples { limit: 999, .. }), "{problem}");
    let endless = format!("NRRD0004\n#{}", "-".repeat(2 << 20));
    folder.write("a.nrrd", endless);
    assert!(matches!(*folder.read("a.nrrd").unwrap_err().problem, Problem::HeaderTooLong { .. }));
}

/// Every cut of a file is an error, but for the white space at the end of text.
#[test]
fn every_cut_is_an_error() {
    let folder = Folder::new();
    for encoding in ["raw", "gzip", "hex"] {
        let header = nrrd_header("i16", encoding, true);
        let whole = [header.as_bytes(), b"\n", &encoded(&bytes("i16", true), encoding, "i16")].concat();
        // The last byte of hex is a line end.
        let shortest = whole.len() - usize::from(encoding == "hex");
        for end in 0..shortest {
            folder.write("a.nrrd", &whole[..end]);
            assert!(folder.read("a.nrrd").is_err(), "{encoding} cut at {end} of {}", whole.len());
        }
    }
}
