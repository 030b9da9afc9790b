//! What rendered samples show, in shares and ranges.

use super::people::Persons;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// What samples are drawn.
#[derive(Clone, Debug, Serialize)]
pub struct SampleSpec {
    /// Longer side of the box round the 68 points \[px\].
    pub face_px: (f32, f32),
    /// Space round that box on each side, in its longer side.
    pub margin: f32,
    /// Largest |yaw| \[deg\].
    pub yaw_deg: f32,
    /// Share of the samples within two thirds of that; they are uniform inside each band.
    pub inner_share: f32,
    /// Largest |pitch| \[deg\].
    pub pitch_deg: f32,
    /// Largest |roll| \[deg\].
    pub roll_deg: f32,
    /// Share of samples with a hand or a lump in front.
    pub occluders: f64,
    /// Share of samples with glasses.
    pub glasses: f64,
    /// Share of people who wear their hair long.
    pub long_hair: f64,
    /// Share of samples with a cap.
    pub caps: f64,
    /// Share of samples with a mask.
    pub masks: f64,
    /// Share of samples whose lids are anywhere between open and shut.
    pub closing: f64,
    /// Share of samples that look anywhere within what eyes reach, with lids that follow.
    #[serde(skip_serializing_if = "is_none")]
    pub looking: f64,
    /// Share of samples whose eyeballs look odd: too bright or dark, without an iris, mottled by
    /// reflections.
    pub odd_eyes: f64,
    /// Share of near-infrared samples.
    pub infrared: f64,
    /// Share of these whose pupils send the light back.
    #[serde(skip_serializing_if = "is_none")]
    pub bright_pupils: f64,
    /// Share of samples before a photograph, or what stands for one (the rest: gradients, clouds
    /// and panels).
    pub photo_backgrounds: f64,
    /// Blur and noise, in shares of the most that small faces have.
    pub defects: f32,
    /// Whose skins are used.
    pub persons: Persons,
    /// Share of samples as photographs mostly are; see [`SampleSpec::everyday`]. The others are
    /// harder.
    #[serde(skip_serializing_if = "is_none")]
    pub everyday: f64,
    /// Share of MakeHuman's heads, if there are any.
    #[serde(skip_serializing_if = "is_none")]
    pub makehuman: f64,
    /// Share of samples among a panorama, if there are any.
    #[serde(skip_serializing_if = "is_none")]
    pub panoramas: f64,
    /// Whether a blink of 1 shuts the eyes of every head.
    #[serde(skip_serializing_if = "is_false")]
    pub shutting: bool,
}

fn is_false(is: &bool) -> bool {
    !is
}

fn is_none(share: &f64) -> bool {
    *share == 0.0
}

impl Default for SampleSpec {
    fn default() -> Self {
        SampleSpec {
            face_px: (40.0, 110.0),
            margin: 0.6,
            yaw_deg: 100.0,
            inner_share: 0.55,
            pitch_deg: 40.0,
            roll_deg: 35.0,
            occluders: 0.2,
            glasses: 0.15,
            long_hair: 0.25,
            caps: 0.06,
            masks: 0.04,
            closing: 0.1,
            looking: 0.0,
            odd_eyes: 0.1,
            infrared: 0.12,
            bright_pupils: 0.0,
            photo_backgrounds: 0.75,
            defects: 1.0,
            persons: Persons::All,
            everyday: 0.0,
            makehuman: 0.0,
            panoramas: 0.0,
            shutting: false,
        }
    }
}

impl SampleSpec {
    /// The same with heads, poses and accessories as photographs mostly show them.
    pub fn everyday(&self) -> SampleSpec {
        SampleSpec {
            yaw_deg: self.yaw_deg.min(60.0),
            inner_share: 0.85,
            pitch_deg: 25.0,
            roll_deg: 25.0,
            occluders: 0.05,
            long_hair: 0.2,
            caps: 0.03,
            masks: 0.0,
            odd_eyes: 0.0,
            infrared: 0.03,
            everyday: 1.0,
            ..self.clone()
        }
    }

    /// That of a sample: an everyday one, or a harder one.
    pub(super) fn drawn(&self, rng: &mut ChaCha8Rng) -> SampleSpec {
        match self.everyday > 0.0 && rng.random_bool(self.everyday) {
            true => self.everyday(),
            false => SampleSpec {
                everyday: 0.0,
                ..self.clone()
            },
        }
    }

    /// Faces seen from near: as sharp as a closer crop can be, lids anywhere.
    pub fn near() -> SampleSpec {
        SampleSpec {
            face_px: (50.0, 240.0),
            inner_share: 0.75,
            closing: 0.25,
            glasses: 0.12,
            infrared: 0.1,
            defects: 0.5,
            ..SampleSpec::default()
        }
    }

    /// Eyes that look around, open, shut and half way, behind glasses too.
    pub fn eyes() -> SampleSpec {
        SampleSpec {
            face_px: (50.0, 230.0),
            margin: 0.05,
            yaw_deg: 63.0,
            inner_share: 0.8,
            pitch_deg: 30.0,
            roll_deg: 25.0,
            occluders: 0.2,
            glasses: 0.45,
            long_hair: 0.1,
            caps: 0.03,
            closing: 0.0,
            looking: 1.0,
            shutting: true,
            odd_eyes: 0.03,
            infrared: 0.35,
            bright_pupils: 0.35,
            defects: 0.6,
            ..SampleSpec::default()
        }
    }
}
