//! What models are trained on, with its terms. A recipe is the same for every model: it is given a
//! list of sources, those whose terms allow it.

use crate::head::Labels;
use crate::photographs::{CROPS, Framing, MANUAL, MANUAL_MORE, PORTRAITS, PROFILES, Set, VIDEO};
use anyhow::{Result, ensure};

/// What a source's terms allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Terms {
    /// Any use, also in products.
    Free,
    /// Research; other uses may be restricted.
    Research,
}

impl Terms {
    /// As options and data sheets have them.
    pub fn name(self) -> &'static str {
        match self {
            Terms::Free => "free",
            Terms::Research => "research",
        }
    }
}

/// What a source is.
#[derive(Clone, Copy, Debug)]
pub enum What {
    /// Labelled photographs of faces.
    Photographs(Set),
    /// Photographs of single eyes, open and shut.
    SingleEyes,
    /// The same in near-infrared light.
    InfraredEyes,
    /// Photographs without people.
    Backgrounds,
    /// The morphable head, which is rendered and fitted.
    MorphableHead,
    /// MakeHuman's heads, which are rendered.
    MakeHuman,
    /// Panoramas, as light and backgrounds of renders.
    Panoramas,
}

/// A source of training data.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// As `--without` calls it.
    pub name: &'static str,
    pub what: What,
    pub terms: Terms,
    /// What the data sheet says of it.
    pub sheet: &'static str,
}

/// All of them.
pub const ALL: [Source; 12] = [
    Source {
        name: "facekit",
        what: What::MorphableHead,
        terms: Terms::Free,
        sheet: "ICT Face Model Light (MIT, (c) 2020 USC Institute for Creative Technologies): heads
  that are rendered, and the 3D face",
    },
    Source {
        name: "makehuman",
        what: What::MakeHuman,
        terms: Terms::Free,
        sheet: "heads, skins, hair, brows, lashes, eyes and teeth of MakeHuman (CC0), rendered",
    },
    Source {
        name: "panoramas",
        what: What::Panoramas,
        terms: Terms::Free,
        sheet: "18 panoramas of Poly Haven (CC0), as light and backgrounds of renders",
    },
    Source {
        name: "portraits",
        what: What::Photographs(PORTRAITS),
        terms: Terms::Free,
        sheet: "portraits of some 3,000 members of the United States Congress (public domain: works
  of the US government, or published before 1932), with landmarks by MediaPipe's face mesh (Apache
  2.0), mapped to the 300-W convention by a linear map that was learnt on 999 photographs with
  manual landmarks",
    },
    Source {
        name: "manual",
        what: What::Photographs(MANUAL),
        terms: Terms::Research,
        sheet: "999 photographs of HELEN and AFW with the manual landmarks of the 300-W challenge
  (research, not commercial)",
    },
    Source {
        name: "lfpw",
        what: What::Photographs(MANUAL_MORE),
        terms: Terms::Research,
        sheet:
            "805 photographs of LFPW's train set with the manual landmarks of the 300-W challenge
  (research)",
    },
    Source {
        name: "profiles",
        what: What::Photographs(PROFILES),
        terms: Terms::Research,
        sheet: "1,236 photographs of 204 celebrities in frontal and profile views with manual
  landmarks on one half of the face (CFP; research)",
    },
    Source {
        name: "video",
        what: What::Photographs(VIDEO),
        terms: Terms::Research,
        sheet: "2,979 photographs (video frames of 245 public figures) of the facial-keypoints set
  published by Udacity (repository MIT) out of the YouTube Faces database (research), with landmarks
  as the mean of three public networks (MediaPipe's face mesh, a 98-point and a 68-point PFLD),
  mapped to the 300-W convention",
    },
    Source {
        name: "crops",
        what: What::Photographs(CROPS),
        terms: Terms::Research,
        sheet: "11,068 photographs of some 5,400 people out of Labeled Faces in the Wild and IMFDB,
  by way of a public expression set, and 5,992 of UTKFace (all research), with landmarks as of the
  video frames",
    },
    Source {
        name: "single-eyes",
        what: What::SingleEyes,
        terms: Terms::Research,
        sheet: "816 photographs of single eyes, open and shut, of a public drowsiness set (Kaggle,
  research)",
    },
    Source {
        name: "infrared-eyes",
        what: What::InfraredEyes,
        terms: Terms::Research,
        sheet:
            "4,000 photographs of single eyes in near-infrared light, open and shut, of a handful
  of people (MRL Eye Dataset, research)",
    },
    Source {
        name: "backgrounds",
        what: What::Backgrounds,
        terms: Terms::Research,
        sheet: "natural photographs without people of BSDS500 (research), as backgrounds and
  negatives",
    },
];

/// The sources of one model.
#[derive(Clone, Debug)]
pub struct Sources(Vec<Source>);

impl Sources {
    /// Those whose terms are these or allow more, without the ones named.
    ///
    /// # Errors
    /// When a name is not that of a source.
    pub fn new(terms: Terms, without: &[String]) -> Result<Sources> {
        for name in without {
            let known = ALL.iter().any(|s| s.name == name);
            ensure!(known, "no source is called {name}");
        }
        let chosen = |s: &&Source| s.terms <= terms && !without.iter().any(|w| w == s.name);
        Ok(Sources(ALL.iter().filter(chosen).copied().collect()))
    }

    /// In the order of [`ALL`].
    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        self.0.iter()
    }

    /// The sets of photographs.
    pub fn sets(&self) -> impl Iterator<Item = Set> {
        self.0.iter().filter_map(|source| match source.what {
            What::Photographs(set) => Some(set),
            _ => None,
        })
    }

    /// Whose landmarks are to be moved to where people mark them; `None` where people set some.
    pub fn labels(&self) -> Option<Labels> {
        if self.sets().any(|set| set.by_people) {
            return None;
        }
        Some(match self.sets().next() {
            Some(_) => Labels::FaceMesh,
            None => Labels::Convention,
        })
    }

    /// Sets to fit the 3D head to and to take skins from.
    pub fn whole(&self) -> Vec<Set> {
        self.sets()
            .filter(|set| set.framing == Framing::Whole)
            .collect()
    }

    /// Whether photographs of single eyes are among them.
    pub fn has_single_eyes(&self) -> bool {
        self.has(|what| matches!(what, What::SingleEyes))
    }

    /// Folders of photographs of single eyes, those in infrared light too.
    pub fn single_eyes(&self) -> Vec<&'static str> {
        let folders = self.0.iter().filter_map(|source| match source.what {
            What::SingleEyes => Some("eyes"),
            What::InfraredEyes => Some("eyes-nir"),
            _ => None,
        });
        folders.collect()
    }

    /// Whether photographs without people are among them.
    pub fn has_backgrounds(&self) -> bool {
        self.has(|what| matches!(what, What::Backgrounds))
    }

    /// Whether MakeHuman's heads are among them.
    pub fn has_makehuman(&self) -> bool {
        self.has(|what| matches!(what, What::MakeHuman))
    }

    /// Whether panoramas are among them.
    pub fn has_panoramas(&self) -> bool {
        self.has(|what| matches!(what, What::Panoramas))
    }

    fn has(&self, is_wanted: impl Fn(&What) -> bool) -> bool {
        self.0.iter().any(|source| is_wanted(&source.what))
    }

    /// What the strictest terms of the sources allow.
    pub fn terms(&self) -> Terms {
        self.0.iter().map(|s| s.terms).max().unwrap_or(Terms::Free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_model_has_free_sources_only() {
        let free = Sources::new(Terms::Free, &[]).unwrap();
        assert!(free.iter().all(|s| s.terms == Terms::Free));
        assert!(free.sets().count() > 0 && !free.has_backgrounds() && !free.has_single_eyes());
        let all = Sources::new(Terms::Research, &[]).unwrap();
        assert_eq!(all.iter().count(), ALL.len());
        assert_eq!(all.terms(), Terms::Research);
    }

    #[test]
    fn sources_can_be_left_out() {
        let without = ["portraits".to_owned()];
        let fewer = Sources::new(Terms::Free, &without).unwrap();
        assert_eq!(fewer.sets().count(), 0);
        assert!(Sources::new(Terms::Free, &["nobody".to_owned()]).is_err());
    }
}
