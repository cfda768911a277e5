//! Numbers as files have them: their types, their bytes, their text.

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberKind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Numbers, whole or not.
#[derive(Debug)]
pub(crate) enum Numbers {
    Whole(Vec<i64>),
    Real(Vec<f64>),
}

impl NumberKind {
    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn is_real(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The numbers of so many whole elements; bytes beyond the last are left out.
    pub(crate) fn of_bytes(self, bytes: &[u8], big_endian: bool) -> Numbers {
        macro_rules! each {
            ($type:ty, $of:ident, $into:ty) => {
                Numbers::$of(
                    bytes
                        .chunks_exact(size_of::<$type>())
                        .map(|chunk| {
                            let chunk = chunk.try_into().expect("as long as the type");
                            let number = if big_endian {
                                <$type>::from_be_bytes(chunk)
                            } else {
                                <$type>::from_le_bytes(chunk)
                            };
                            number as $into
                        })
                        .collect(),
                )
            };
        }
        match self {
            Self::I8 => each!(i8, Whole, i64),
            Self::U8 => each!(u8, Whole, i64),
            Self::I16 => each!(i16, Whole, i64),
            Self::U16 => each!(u16, Whole, i64),
            Self::I32 => each!(i32, Whole, i64),
            Self::U32 => each!(u32, Whole, i64),
            Self::I64 => each!(i64, Whole, i64),
            // Beyond 2^63 it becomes negative, which no count and no point is.
            Self::U64 => each!(u64, Whole, i64),
            Self::F32 => each!(f32, Real, f64),
            Self::F64 => each!(f64, Real, f64),
        }
    }

    /// The numbers of words, so many at most.
    ///
    /// # Errors
    /// The first word that is no number of the type, with its place from 0.
    pub(crate) fn of_words<'a>(
        self,
        words: impl Iterator<Item = &'a [u8]>,
        most: u64,
    ) -> Result<Numbers, (usize, &'a [u8])> {
        let words = words.take(usize::try_from(most).unwrap_or(usize::MAX)).enumerate();
        if self.is_real() {
            let real = words.map(|(place, word)| real(word).ok_or((place, word)));
            // A number of single precision is rounded once, as VTK reads it.
            let real =
                real.map(|number| number.map(|of| if self == Self::F32 { f64::from(of as f32) } else { of }));
            return real.collect::<Result<_, _>>().map(Numbers::Real);
        }
        let whole = words.map(|(place, word)| whole(word).ok_or((place, word)));
        whole.collect::<Result<_, _>>().map(Numbers::Whole)
    }
}

impl Numbers {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Whole(numbers) => numbers.len(),
            Self::Real(numbers) => numbers.len(),
        }
    }

    /// As real numbers; whole ones beyond 2^53 are rounded.
    pub(crate) fn into_real(self) -> Vec<f64> {
        match self {
            Self::Whole(numbers) => numbers.into_iter().map(|number| number as f64).collect(),
            Self::Real(numbers) => numbers,
        }
    }

    /// As whole numbers, if they are.
    pub(crate) fn into_whole(self) -> Option<Vec<i64>> {
        match self {
            Self::Whole(numbers) => Some(numbers),
            Self::Real(_) => None,
        }
    }
}

/// The number that a word is; `nan` and `inf` are some.
pub(crate) fn real(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

pub(crate) fn whole(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The words of a text.
pub(crate) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|byte| byte.is_ascii_whitespace()).filter(|word| !word.is_empty())
}

/// Three numbers each.
pub(crate) fn triples(numbers: &[f64]) -> Vec<[f64; 3]> {
    numbers.chunks_exact(3).map(|at| [at[0], at[1], at[2]]).collect()
}
