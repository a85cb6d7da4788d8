//! Which word a misspelt one stands for.

/// Longer words are not compared: it takes time, and nobody misspells them.
const LONGEST: usize = 64;

/// What is called otherwise in other languages, and its name here.
const ELSEWHERE: [(&str, &str); 26] = [
    ("sinus", "sin"),
    ("sine", "sin"),
    ("cosinus", "cos"),
    ("cosine", "cos"),
    ("tangens", "tan"),
    ("tangent", "tan"),
    ("tg", "tan"),
    ("arctg", "atan"),
    ("arctan", "atan"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan2", "atan2"),
    ("log", "ln"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("micron", "um"),
    ("microns", "um"),
    ("turns", "rev"),
    ("π", "pi"),
    ("int", "count"),
    ("integer", "count"),
    ("float", "number"),
    ("double", "number"),
    ("real", "number"),
];

/// The candidate that a misspelt word most likely stands for: the first of the nearest, with no more than one mistake (a letter too many,
/// too few, another, or two that changed places) in three letters of the word, or one, and fewer than there are letters. How the
/// words of a name are set apart is no mistake: `rotateZ` is `rotate_z`. A name from elsewhere is the one here: `sinus` is `sin`.
pub fn closest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let letters = word.chars().take(LONGEST + 1).count();
    if letters > LONGEST {
        return None;
    }
    let letters_of = |word: &str| word.replace('_', "").to_lowercase();
    let own = letters_of(word);
    let most = (letters / 3).max(1);
    let mistakes = |candidate: &str| {
        let other = letters_of(candidate);
        let shorter = own.chars().count().min(other.chars().count());
        Some(strsim::osa_distance(&own, &other)).filter(|&mistakes| mistakes <= most && mistakes < shorter)
    };
    let candidates: Vec<&'c str> = candidates.into_iter().collect();
    let here = ELSEWHERE.iter().find(|(elsewhere, _)| *elsewhere == word).map(|(_, here)| *here);
    if let Some(meant) = candidates.iter().find(|candidate| Some(**candidate) == here) {
        return Some(meant);
    }
    let near = candidates.into_iter().filter_map(|candidate| Some((mistakes(candidate)?, candidate)));
    // of those alike, the one that is written most alike
    near.min_by_key(|&(mistakes, candidate)| (mistakes, strsim::osa_distance(word, candidate))).map(|(_, near)| near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_off_is_no_misspelling() {
        let known = ["helical_gear", "Spur", "hob", "hub", "Z", "rotate", "rotate_x", "rotate_z"];
        for (word, meant) in [
            ("helical_gaer", Some("helical_gear")),
            ("HELICAL_GEAR", Some("helical_gear")),
            ("spur", Some("Spur")),
            ("hib", Some("hob")),
            ("xyz", None),
            ("z", Some("Z")),
            ("h", None),
            ("ZZ", None),
            ("rotateZ", Some("rotate_z")),
            ("RotateX", Some("rotate_x")),
            ("helicalGaer", Some("helical_gear")),
            ("ho_b", Some("hob")),
            ("_", None),
            ("", None),
        ] {
            assert_eq!(closest(word, known), meant, "{word}");
        }
        assert_eq!(closest(&"h".repeat(100_000), known), None);
    }

    #[test]
    fn a_name_from_elsewhere_is_the_one_here() {
        assert_eq!(closest("sinus", ["sin", "minus"]), Some("sin"));
        assert_eq!(closest("arctg", ["atan2", "atan"]), Some("atan"));
        // where it means nothing here, it is a word like others
        assert_eq!(closest("sinus", ["hub", "minus"]), Some("minus"));
    }
}
