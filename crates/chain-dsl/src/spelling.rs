//! Which word a misspelt one stands for.

/// Longer words are not compared: it takes time, and nobody misspells them.
const LONGEST: usize = 64;

/// The candidate that a misspelt word most likely stands for: the same in other letters' size, else the first of the nearest, with no
/// more than one mistake (a letter too many, too few, another, or two that changed places) in three letters of the word, or one, and
/// fewer than there are letters.
pub fn closest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let letters = word.chars().take(LONGEST + 1).count();
    if letters > LONGEST {
        return None;
    }
    let lower = word.to_lowercase();
    let mistakes = |candidate: &str| match candidate.to_lowercase() == lower {
        true => Some(0),
        false => Some(strsim::osa_distance(word, candidate))
            .filter(|&mistakes| mistakes <= (letters / 3).max(1) && mistakes < letters.min(candidate.chars().count())),
    };
    let near = candidates.into_iter().filter_map(|candidate| Some((mistakes(candidate)?, candidate)));
    near.min_by_key(|&(mistakes, _)| mistakes).map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_off_is_no_misspelling() {
        let known = ["helical_gear", "Spur", "hob", "hub", "Z"];
        for (word, meant) in [
            ("helical_gaer", Some("helical_gear")),
            ("HELICAL_GEAR", Some("helical_gear")),
            ("spur", Some("Spur")),
            ("hib", Some("hob")),
            ("xyz", None),
            ("z", Some("Z")),
            ("h", None),
            ("ZZ", None),
            ("", None),
        ] {
            assert_eq!(closest(word, known), meant, "{word}");
        }
        assert_eq!(closest(&"h".repeat(100_000), known), None);
    }
}
