(* SPDX-License-Identifier: MIT *)
(* What Roundings.v assumes of a device, proved of IEEE 754's formats as Flocq defines them.

   binary32: results are rounded to nearest, ties in any way; and wherever a result or an operand is below 2^-126, it may
   be taken for 0 or not. So the bounds hold where denormals are kept, flushed, or both by turns.
   binary64: no result is a denormal (Det3Double.v says why). *)
From Coq Require Import Reals ZArith Lra Lia.
From Flocq Require Import Core Relative.
Open Scope R_scope.

Definition u32 := bpow radix2 (-24).
Definition h32 := bpow radix2 (-126).
Definition rounded32 choice s := round radix2 (FLT_exp (-149) 24) (Znearest choice) s.
Definition rounds32 s v := (exists choice, v = rounded32 choice s) \/ (Rabs s < h32 /\ v = 0).
Definition seen32 v w := w = v \/ (Rabs v < h32 /\ w = 0).

Lemma rounds32_near s v : rounds32 s v -> Rabs (v - s) <= u32 * Rabs s + h32.
Proof.
  assert (u0 : 0 < u32) by apply bpow_gt_0. assert (S0 := Rabs_pos s).
  intros [[choice ->] | [small ->]].
  - destruct (error_N_FLT radix2 (-149) 24 ltac:(lia) choice s) as [eps [eta [He [Hn [_ Hr]]]]].
    unfold rounded32; rewrite Hr. replace (s * (1 + eps) + eta - s) with (eps * s + eta) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult.
    assert (Rabs eps <= u32) by (eapply Rle_trans; [apply He | unfold u32; simpl; lra]).
    assert (Rabs eta <= h32) by (eapply Rle_trans; [apply Hn | unfold h32; simpl; lra]).
    assert (Rabs eps * Rabs s <= u32 * Rabs s) by (apply Rmult_le_compat_r; auto). lra.
  - rewrite Rminus_0_l, Rabs_Ropp. assert (0 <= u32 * Rabs s) by (apply Rmult_le_pos; lra). lra.
Qed.

Lemma seen32_near v w : seen32 v w -> Rabs (w - v) <= h32.
Proof.
  assert (h0 : 0 < h32) by apply bpow_gt_0. intros [-> | [small ->]].
  - rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. lra.
  - rewrite Rminus_0_l, Rabs_Ropp. lra.
Qed.

(* binary32 where nothing underflows. *)
Definition rounds_normal s v :=
  (s = 0 \/ bpow radix2 (-126) <= Rabs s) /\ exists choice, v = round radix2 (FLT_exp (-149) 24) (Znearest choice) s.
Lemma rounds_normal_near s v : rounds_normal s v -> Rabs (v - s) <= u32 * Rabs s + 0.
Proof.
  intros [[-> | normal] [choice ->]].
  - rewrite round_0 by apply valid_rnd_N. rewrite Rminus_0_r, Rabs_R0. lra.
  - assert (H := relative_error_N_FLT radix2 (-149) 24 ltac:(lia) choice s normal).
    eapply Rle_trans; [apply H |]. unfold u32; simpl; lra.
Qed.

Definition u64 := bpow radix2 (-53).
Definition rounds64 s v :=
  (s = 0 \/ bpow radix2 (-1022) <= Rabs s) /\ exists choice, v = round radix2 (FLT_exp (-1074) 53) (Znearest choice) s.
Definition seen64 (v w : R) := w = v.

Lemma rounds64_near s v : rounds64 s v -> Rabs (v - s) <= u64 * Rabs s + 0.
Proof.
  intros [[-> | normal] [choice ->]].
  - rewrite round_0 by apply valid_rnd_N. rewrite Rminus_0_r, Rabs_R0. lra.
  - assert (H := relative_error_N_FLT radix2 (-1074) 53 ltac:(lia) choice s normal).
    eapply Rle_trans; [apply H |]. unfold u64; simpl; lra.
Qed.

Lemma seen64_near v w : seen64 v w -> Rabs (w - v) <= 0.
Proof. intros ->. rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. lra. Qed.

(* binary64 like binary32 above: denormals kept, flushed, or both by turns. *)
Definition h64 := bpow radix2 (-1022).
Definition rounds64_any s v :=
  (exists choice, v = round radix2 (FLT_exp (-1074) 53) (Znearest choice) s) \/ (Rabs s < h64 /\ v = 0).
Definition seen64_any v w := w = v \/ (Rabs v < h64 /\ w = 0).

Lemma rounds64_any_near s v : rounds64_any s v -> Rabs (v - s) <= u64 * Rabs s + h64.
Proof.
  assert (u0 : 0 < u64) by apply bpow_gt_0. assert (S0 := Rabs_pos s).
  intros [[choice ->] | [small ->]].
  - destruct (error_N_FLT radix2 (-1074) 53 ltac:(lia) choice s) as [eps [eta [He [Hn [_ Hr]]]]].
    rewrite Hr. replace (s * (1 + eps) + eta - s) with (eps * s + eta) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult.
    assert (Rabs eps <= u64) by (eapply Rle_trans; [apply He | unfold u64; simpl; lra]).
    assert (Rabs eta <= h64).
    { eapply Rle_trans; [apply Hn |]. assert (L := bpow_le radix2 (-1074) (-1022) ltac:(lia)).
      assert (P := bpow_gt_0 radix2 (-1074)). unfold h64. lra. }
    assert (Rabs eps * Rabs s <= u64 * Rabs s) by (apply Rmult_le_compat_r; auto). lra.
  - rewrite Rminus_0_l, Rabs_Ropp. assert (0 <= u64 * Rabs s) by (apply Rmult_le_pos; lra). lra.
Qed.

Lemma seen64_any_near v w : seen64_any v w -> Rabs (w - v) <= h64.
Proof.
  assert (h0 : 0 < h64) by apply bpow_gt_0. intros [-> | [small ->]].
  - rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. lra.
  - rewrite Rminus_0_l, Rabs_Ropp. lra.
Qed.
